// Settings of integrators: one table per integrator feeds the parser of -D, the help, the docs and the defaults.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

namespace dapple {

struct SettingInfo {
    std::string_view name;
    std::string_view unit;      // "", "scene units", "photons", ...
    std::string_view fallback;  // default as text; "auto" where it comes from the scene
    std::string_view range;     // "> 0", "constant|cone|...": forms in base/ranges.h; "": any text
    std::string_view text;      // one sentence
};

// Values by name, checked against a table. Values are texts as the user typed them, e.g. "1e6", "2M", "0.5", "true".
class Settings {
public:
    explicit Settings(std::span<const SettingInfo> table) : table_(table) {}

    // Throws UserError for a name that is not in the table (with the nearest known) or a value out of form.
    void set(const std::string& name, const std::string& value);

    bool is_auto(std::string_view name) const;
    double number(std::string_view name) const;  // accepts 1e6, 500k, 2M, 1G
    int64_t integer(std::string_view name) const;
    // The same, and `if_auto` where the value is "auto".
    double number_or(std::string_view name, double if_auto) const { return is_auto(name) ? if_auto : number(name); }
    int64_t integer_or(std::string_view name, int64_t if_auto) const { return is_auto(name) ? if_auto : integer(name); }
    bool boolean(std::string_view name) const;
    std::string_view word(std::string_view name) const;

    // What was set, by name; the rest has its default.
    const std::map<std::string, std::string, std::less<>>& values() const { return values_; }

private:
    std::string_view text(std::string_view name) const;
    const SettingInfo& info(std::string_view name) const;

    std::span<const SettingInfo> table_;
    std::map<std::string, std::string, std::less<>> values_;
};

}  // namespace dapple
