// A new folder that nobody else writes into, whatever runs beside; it goes with this.
#pragma once

#include "dapple/base/error.h"

#include <cstdlib>  // mkdtemp
#include <filesystem>
#include <string>
#include <system_error>

namespace dapple {

// Where temporary files go: what TMPDIR and the like name, or /tmp where that is no folder. Never throws.
inline std::filesystem::path temp_path()
{
    std::error_code error;
    const std::filesystem::path path = std::filesystem::temp_directory_path(error);
    return error ? std::filesystem::path("/tmp") : path;
}

class TempFolder {
public:
    TempFolder()
    {
        std::string name = (temp_path() / "dapple-XXXXXX").string();
        if (!mkdtemp(name.data())) throw UserError("cannot make a folder like " + name);
        path_ = name;
    }
    ~TempFolder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);  // of links, these alone
    }
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

}  // namespace dapple
