// A text that is being read, and the places in it. Lines are counted when a place is asked for, not while reading.
#pragma once

#include "dapple/base/error.h"

#include <string>
#include <string_view>

namespace dapple {

class SourceText {
public:
    SourceText(std::string name, std::string text)
        : name_(std::move(name)), text_(std::move(text)), counted_to_(begin())
    {
    }
    SourceText(const SourceText&) = delete;
    SourceText& operator=(const SourceText&) = delete;

    const std::string& name() const { return name_; }
    const char* begin() const { return text_.data(); }
    const char* end() const { return text_.data() + text_.size(); }

    // File, line and column of a position in the text. Costs the distance to the place asked for before. Not
    // thread-safe.
    SourceLocation locate(const char* at) const;

private:
    std::string name_;
    std::string text_;
    mutable const char* counted_to_;  // stands in line_
    mutable int line_ = 1;
};

}  // namespace dapple
