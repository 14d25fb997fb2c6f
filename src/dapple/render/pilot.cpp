#include "dapple/render/pilot.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace dapple {
namespace {

constexpr double enough_to_tell = 0.015;  // a trial of this part of the time
constexpr double surely = 0.25;           // of what it may take: no more trials are needed
constexpr int64_t growth = 4;             // from trial to trial

// "1,250,000"
std::string with_commas(int64_t number)
{
    std::string text = std::to_string(number);
    for (auto at = static_cast<int>(text.size()) - 3; at > 0; at -= 3) text.insert(static_cast<size_t>(at), ",");
    return text;
}

// Does what comes before the first eye path of a pass, with settings that are thrown away.
class Trials {
public:
    Trials(const IntegratorChoice& choice, const World& world, const FilmSettings& film, uint64_t seed)
        : choice_(choice), world_(world), seed_(seed), film_(without_errors(film))
    {
    }

    std::vector<Effort> efforts() const
    {
        Statistics unused;
        return choice_.entry->create(world_, choice_.settings)->efforts(context(unused), film_.settings());
    }

    // Every other effort is the least.
    double seconds(const std::vector<Effort>& efforts, const Effort& of, int64_t n)
    {
        Settings settings = choice_.settings;
        for (const Effort& effort : efforts)
            settings.set(std::string(effort.setting), std::to_string(effort.setting == of.setting ? n : effort.least));
        const std::unique_ptr<Integrator> integrator = choice_.entry->create(world_, settings);
        Statistics unused;
        const auto start = std::chrono::steady_clock::now();
        integrator->render_pass(context(unused), film_);
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

private:
    static FilmSettings without_errors(FilmSettings film)
    {
        film.error_layer = false;
        return film;
    }

    PassContext context(Statistics& statistics) const
    {
        PassContext context{world_, seed_, film_.settings().first_pass, statistics};
        context.without_eye_paths = true;
        return context;
    }

    const IntegratorChoice& choice_;
    const World& world_;
    uint64_t seed_;
    Film film_;
};

}  // namespace

int64_t affordable(const Effort& effort, double seconds, const std::function<double(int64_t n)>& try_out)
{
    const double budget = effort.share * seconds;
    int64_t n = std::min(effort.least, effort.automatic);
    double taken = try_out(n);
    double slope = taken / static_cast<double>(n);  // [s] for one more
    const auto expected = [&](int64_t number) { return taken + slope * static_cast<double>(number - n); };
    for (double enough = 4 * enough_to_tell * seconds;  // one trial alone does not tell what is fixed: it must be long
         n < effort.automatic && taken < enough && expected(effort.automatic) > surely * budget;
         enough = enough_to_tell * seconds) {
        const int64_t next = std::min((taken < enough_to_tell * seconds ? growth : 2) * n, effort.automatic);
        const double longer = try_out(next);
        // What takes long whatever the number is no reason to lower it; but a first trial may be slow in warming up.
        slope = std::max((longer - taken) / static_cast<double>(next - n), 0.5 * longer / static_cast<double>(next));
        n = next;
        taken = longer;
    }
    int64_t chosen = effort.automatic;
    while (chosen > effort.least && expected(chosen) > budget) chosen = std::max(chosen / 2, effort.least);
    return chosen;
}

std::vector<std::string> fit_to_time(IntegratorChoice& choice, const World& world, const FilmSettings& film,
                                     uint64_t seed, double seconds)
{
    Trials trials(choice, world, film, seed);
    const std::vector<Effort> efforts = trials.efforts();
    std::vector<std::string> lowered;
    for (const Effort& effort : efforts) {
        if (!choice.settings.is_auto(effort.setting)) continue;
        const int64_t chosen =
            affordable(effort, seconds, [&](int64_t n) { return trials.seconds(efforts, effort, n); });
        if (chosen >= effort.automatic) continue;
        choice.settings.set(std::string(effort.setting), std::to_string(chosen));
        lowered.push_back(
            fmt::format("{} {} instead of {}", with_commas(chosen), effort.of, with_commas(effort.automatic)));
    }
    return lowered;
}

}  // namespace dapple
