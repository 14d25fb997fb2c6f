// Messages to people, on stderr. spdlog is hidden behind these three calls; hot code never logs.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace dapple {

enum class LogLevel { debug, info, warning, silent };

void set_log_level(LogLevel level);
// A warning that was logged before is not repeated.
void log_message(LogLevel level, const std::string& message);

template <class... Args>
void log_info(fmt::format_string<Args...> format, Args&&... args)
{
    log_message(LogLevel::info, fmt::format(format, std::forward<Args>(args)...));
}

template <class... Args>
void log_warning(fmt::format_string<Args...> format, Args&&... args)
{
    log_message(LogLevel::warning, fmt::format(format, std::forward<Args>(args)...));
}

// The warnings logged so far in this process, for `dapple inspect` and for tests.
std::vector<std::string> logged_warnings();

}  // namespace dapple
