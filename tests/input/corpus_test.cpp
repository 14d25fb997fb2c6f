// Reads each scene of corpus/ and compares the error, file, line, column and text, with corpus/expected.tsv.
#include "dapple/formats/pbrt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace dapple {
namespace {

const std::filesystem::path corpus = DAPPLE_CORPUS;

std::map<std::string, std::string> expected_errors()
{
    std::map<std::string, std::string> expected;
    std::ifstream file(corpus / "expected.tsv");
    for (std::string line; std::getline(file, line);) {
        const size_t tab = line.find('\t');
        if (line.starts_with('#') || tab == line.npos) continue;
        expected[line.substr(0, tab)] = line.substr(tab + 1);
    }
    return expected;
}

std::string error_of(const std::string& scene)
{
    std::string message = "no error";
    try {
        read_pbrt(corpus / scene);
    } catch (const UserError& error) {
        message = error.what();
    }
    const std::string prefix = corpus.string() + "/";
    for (size_t at = message.find(prefix); at != message.npos; at = message.find(prefix))
        message.erase(at, prefix.size());
    return message;
}

TEST(Corpus, HasAnExpectationForEachSceneAndAtLeastSeventy)
{
    const auto expected = expected_errors();
    EXPECT_GE(expected.size(), 70u);
    for (const auto& entry : std::filesystem::directory_iterator(corpus))
        if (entry.path().extension() == ".pbrt") {
            EXPECT_TRUE(expected.contains(entry.path().filename().string())) << entry.path();
        }
}

TEST(Corpus, EachSceneGivesTheErrorExpected)
{
    for (const auto& [scene, message] : expected_errors()) EXPECT_EQ(error_of(scene), message) << scene;
}

TEST(Corpus, EachErrorIsOneShortLine)
{
    for (const auto& [scene, message] : expected_errors()) {
        EXPECT_LT(error_of(scene).size(), 300u) << scene;
        EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0) << scene;
    }
}

}  // namespace
}  // namespace dapple
