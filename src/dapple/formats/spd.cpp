#include "dapple/formats/spd.h"

#include "dapple/formats/pbrt_lexer.h"
#include "dapple/formats/read_file.h"

#include <fmt/format.h>

#include <memory>
#include <vector>

namespace dapple {

scene::Samples spectrum_samples(std::span<const float> pairs, const SourceLocation& where)
{
    if (pairs.empty()) throw UserError(where, "the spectrum has no samples");
    if (pairs.size() % 2 != 0)
        throw UserError(
            where, fmt::format("a spectrum is made of pairs of wavelength and value, got {} numbers", pairs.size()));
    scene::Samples samples;
    for (size_t i = 0; i < pairs.size(); i += 2) {
        if (!(pairs[i] > 0.0f)) throw UserError(where, fmt::format("the wavelength {} nm is not positive", pairs[i]));
        if (i > 0 && !(pairs[i] > pairs[i - 2]))
            throw UserError(where, fmt::format("the wavelengths of a spectrum must increase, but {} nm follows {} nm",
                                               pairs[i], pairs[i - 2]));
        samples.lambda.push_back(pairs[i]);
        samples.values.push_back(pairs[i + 1]);
    }
    return samples;
}

scene::Samples read_spd(const std::filesystem::path& path, const SourceLocation& where)
{
    PbrtLexer lexer(std::make_shared<SourceText>(path.string(), read_file(path, where)));
    std::vector<float> numbers;
    lexer.read_numbers(numbers);
    if (lexer.peek().kind != PbrtToken::Kind::end)
        throw UserError(lexer.locate(lexer.peek().at),
                        fmt::format("expected a number, got '{}'", shown(lexer.peek().text)));
    return spectrum_samples(numbers, {path.string(), 0, 0});
}

}  // namespace dapple
