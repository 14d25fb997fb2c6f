#include "dapple/render/content_hash.h"

#include <gtest/gtest.h>

#include <set>

namespace dapple {
namespace {

TEST(ContentHash, DoesNotDependOnTheCuts)
{
    std::string text(1000, 'a');
    for (size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>(i * 7);
    ContentHash whole;
    whole.add(text.data(), text.size());
    for (const size_t piece : {1, 3, 15, 16, 17, 64, 999}) {
        ContentHash hash;
        for (size_t at = 0; at < text.size(); at += piece)
            hash.add(text.data() + at, std::min(piece, text.size() - at));
        EXPECT_EQ(hash.text(), whole.text()) << piece;
    }
}

TEST(ContentHash, TellsLengthsBitsAndOrderApart)
{
    std::set<std::string> seen;
    const auto add = [&](const std::string& text) {
        ContentHash hash;
        hash.add(text.data(), text.size());
        EXPECT_TRUE(seen.insert(hash.text()).second) << text.size();
    };
    for (size_t length = 0; length < 70; ++length) add(std::string(length, '\0'));
    for (int bit = 0; bit < 64 * 8; ++bit) {
        std::string text(64, '\0');
        text[static_cast<size_t>(bit / 8)] = static_cast<char>(1 << bit % 8);
        add(text);
    }
    EXPECT_EQ(hash_files({"/no/such/file"})[0].second, "missing");
}

}  // namespace
}  // namespace dapple
