#include "dapple/base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>

namespace dapple {
namespace {

std::mutex warnings_mutex;
std::vector<std::string> warnings;

spdlog::logger& logger()
{
    static std::shared_ptr<spdlog::logger> instance = [] {
        auto created = spdlog::stderr_color_mt("dapple");
        created->set_pattern("%^%l%$: %v");
        return created;
    }();
    return *instance;
}

spdlog::level::level_enum to_spdlog(LogLevel level)
{
    switch (level) {
        case LogLevel::debug: return spdlog::level::debug;
        case LogLevel::info: return spdlog::level::info;
        case LogLevel::warning: return spdlog::level::warn;
        case LogLevel::silent: return spdlog::level::off;
    }
    return spdlog::level::info;
}

}  // namespace

void set_log_level(LogLevel level) { logger().set_level(to_spdlog(level)); }

void log_message(LogLevel level, const std::string& message)
{
    if (level == LogLevel::warning) {
        const std::lock_guard lock(warnings_mutex);
        if (std::find(warnings.begin(), warnings.end(), message) != warnings.end()) return;
        warnings.push_back(message);
    }
    logger().log(to_spdlog(level), message);
}

std::vector<std::string> logged_warnings()
{
    const std::lock_guard lock(warnings_mutex);
    return warnings;
}

}  // namespace dapple
