// Tokens, numbers and places of pbrt texts; SPD spectra.
#include "dapple/formats/pbrt_lexer.h"
#include "dapple/formats/spd.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dapple {
namespace {

PbrtLexer lexer_of(const std::string& text) { return PbrtLexer(std::make_shared<SourceText>("a.pbrt", text)); }

TEST(Lexer, SplitsWordsStringsAndBrackets)
{
    PbrtLexer lexer = lexer_of("Shape\"a b\"[1]#x\n\xef\t]");
    EXPECT_EQ(lexer.next().text, "Shape");
    EXPECT_EQ(lexer.peek().text, "a b");
    EXPECT_EQ(lexer.next().kind, PbrtToken::Kind::string);
    EXPECT_EQ(lexer.next().kind, PbrtToken::Kind::open);
    EXPECT_EQ(lexer.next().text, "1");
    EXPECT_EQ(lexer.next().kind, PbrtToken::Kind::close);
    EXPECT_EQ(lexer.next().text, "\xef");
    EXPECT_EQ(lexer.next().kind, PbrtToken::Kind::close);
    EXPECT_EQ(lexer.next().kind, PbrtToken::Kind::end);
    EXPECT_EQ(lexer.next().kind, PbrtToken::Kind::end);
}

TEST(Lexer, ReadsNumbersInAllForms)
{
    PbrtLexer lexer = lexer_of("1 -2.5 +3 .5 4. 1e3 -1E-2 # comment 7\n 1e-60 -1e-400 0x10");
    std::vector<float> values;
    EXPECT_THROW(lexer.read_numbers(values), UserError);  // 0x10
    EXPECT_EQ(values, (std::vector<float>{1, -2.5f, 3, 0.5f, 4, 1000, -0.01f, 0, 0}));
}

TEST(Lexer, RefusesWhatIsNoFiniteNumber)
{
    for (const char* text : {"nan", "-inf", "+-1", "1e99", "--1", "-", ".", "1.5f", "1,2"}) {
        PbrtLexer lexer = lexer_of(text);
        EXPECT_THROW(lexer.read_number(), UserError) << text;
    }
    for (const char* text : {"1.0", "1e2", "2147483648", "a", ""}) {
        PbrtLexer lexer = lexer_of(text);
        EXPECT_THROW(lexer.read_integer(), UserError) << text;
    }
    PbrtLexer lexer = lexer_of("-2147483648");
    EXPECT_EQ(lexer.read_integer(), -2147483647 - 1);
}

TEST(Lexer, ResolvesEscapes)
{
    PbrtLexer lexer = lexer_of(R"("a\"b\\c\td")");
    EXPECT_EQ(lexer.expect_string("x"), "a\"b\\c\td");
}

TEST(SourceText, LocatesInAnyOrder)
{
    const SourceText source("a", "ab\ncd\n\nef");
    const char* text = source.begin();
    for (const auto& [offset, line, column] : {std::array{8, 4, 2}, std::array{0, 1, 1}, std::array{4, 2, 2},
                                               std::array{2, 1, 3}, std::array{9, 4, 3}, std::array{6, 3, 1}}) {
        const SourceLocation where = source.locate(text + offset);
        EXPECT_EQ(where.line, line);
        EXPECT_EQ(where.column, column);
    }
}

TEST(Spd, NeedsIncreasingPairs)
{
    const std::vector<float> good{400, 1, 500, 2};
    const scene::Samples samples = spectrum_samples(good, {});
    EXPECT_EQ(samples.lambda, (std::vector<float>{400, 500}));
    EXPECT_EQ(samples.values, (std::vector<float>{1, 2}));
    for (const std::vector<float>& bad : {std::vector<float>{}, {400}, {400, 1, 400, 2}, {0, 1}, {-1, 1}})
        EXPECT_THROW(spectrum_samples(bad, {}), UserError);
}

}  // namespace
}  // namespace dapple
