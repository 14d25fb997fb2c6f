// Values checked against a range when they are set, so that a mistake is reported before the scene is loaded. A setting
// whose fallback is "auto" also takes "auto".
#include "dapple/integrators/settings.h"

#include "dapple/base/error.h"
#include "dapple/base/ranges.h"

#include <vector>

namespace dapple {
namespace {

bool is_list_of_words(std::string_view range) { return range.find('|') != std::string_view::npos; }

// Throws UserError unless the value has the form that the setting's range asks for.
void check_form(const SettingInfo& info, const std::string& value)
{
    const bool may_be_auto = info.fallback == "auto";
    if (info.range.empty() || (may_be_auto && value == "auto")) return;
    const std::string name = "setting '" + std::string(info.name) + "'";
    if (is_list_of_words(info.range))
        check_word(name, value, info.range);
    else
        parse_number(name, value, info.range, may_be_auto ? " or auto" : "");
}

}  // namespace

void Settings::set(const std::string& name, const std::string& value)
{
    std::vector<std::string_view> known;
    for (const SettingInfo& candidate : table_) {
        if (candidate.name == name) {
            check_form(candidate, value);
            values_[name] = value;
            return;
        }
        known.push_back(candidate.name);
    }
    throw UserError("unknown setting '" + name + "'" + did_you_mean(name, known));
}

const SettingInfo& Settings::info(std::string_view name) const
{
    for (const SettingInfo& candidate : table_)
        if (candidate.name == name) return candidate;
    throw UserError("setting '" + std::string(name) + "' is not in this integrator's table");
}

std::string_view Settings::text(std::string_view name) const
{
    const auto found = values_.find(name);
    return found != values_.end() ? std::string_view(found->second) : info(name).fallback;
}

bool Settings::is_auto(std::string_view name) const { return text(name) == "auto"; }

double Settings::number(std::string_view name) const
{
    return parse_number("setting '" + std::string(name) + "'", std::string(text(name)), "");
}

int64_t Settings::integer(std::string_view name) const
{
    return static_cast<int64_t>(
        parse_number("setting '" + std::string(name) + "'", std::string(text(name)), "integer"));
}

bool Settings::boolean(std::string_view name) const
{
    const std::string_view value = text(name);
    if (value == "true") return true;
    if (value == "false") return false;
    throw UserError("setting '" + std::string(name) + "' takes true|false, not '" + std::string(value) + "'");
}

std::string_view Settings::word(std::string_view name) const { return text(name); }

}  // namespace dapple
