// The memory ceiling: what does not fit is refused with its parts, what is left goes to the integrator.
#include "dapple/render/memory.h"

#include "dapple/base/error.h"
#include "dapple/render/technique_record.h"

#include <gtest/gtest.h>

#include <array>

namespace dapple {
namespace {

constexpr std::array<SettingInfo, 1> table = {{{"memory", "bytes", "auto", "> 0", "ceiling of the photon maps"}}};

class Memory : public testing::Test {
protected:
    Memory()
    {
        film_.resolution = film_.crop_max = Int2(100, 10);
        film_.class_layers = film_.guide_layers = false;
        report_.geometry_bytes = 1000;
        report_.texture_bytes = 500;
        choice_.entry = &entry_;
        choice_.settings = Settings(table);
    }

    void check(uint64_t limit, uint64_t techniques = 0)
    {
        check_memory(limit, memory_account(report_, film_, entry_, techniques), choice_);
    }

    IntegratorEntry entry_{"fake", "", table, true, true, nullptr};
    IntegratorChoice choice_;
    FilmSettings film_;
    CompileReport report_;
};

TEST_F(Memory, IsCountedByParts)
{
    EXPECT_EQ(film_bytes(film_), 100u * 10 * 3 * 16);
    film_.crop_max = Int2(50, 10);
    EXPECT_EQ(film_bytes(film_), 50u * 10 * 3 * 16);
    const MemoryAccount account = memory_account(report_, film_, entry_);
    EXPECT_EQ(account.scene(), 1500u);
    EXPECT_EQ(account.film, 50u * 10 * 3 * 16 * 5 / 4);
    EXPECT_EQ(account.total(), program_bytes + account.scene() + account.film);
}

TEST_F(Memory, RefusesWhatDoesNotFit)
{
    EXPECT_NO_THROW(check(0));
    EXPECT_THROW(check(program_bytes + 61499), UserError);
    EXPECT_NO_THROW(check(program_bytes + 61501));
}

TEST_F(Memory, WhatIsLeftGoesToTheIntegrator)
{
    check(program_bytes + 100000);
    EXPECT_EQ(choice_.settings.integer("memory"), 100000 - 61500);
    choice_.settings.set("memory", "7");
    check(program_bytes + 100000);
    EXPECT_EQ(choice_.settings.integer("memory"), 7) << "the user's own value stays";
}

TEST_F(Memory, CountsWhatAPassKeepsForEachPixel)
{
    entry_.bytes_per_pixel = 10;
    check(program_bytes + 100000);
    EXPECT_EQ(choice_.settings.integer("memory"), 100000 - 61500 - 100 * 10 * 10);
    entry_.bytes_per_pixel = 40;
    EXPECT_THROW(check(program_bytes + 100000), UserError);
}

TEST_F(Memory, CountsASecondFilmUnderATimeLimit)
{
    const uint64_t film = film_bytes(film_);
    EXPECT_EQ(memory_account(report_, film_, entry_, 0, true).film, film / 4 * 5);
    entry_.second_film = true;
    EXPECT_EQ(memory_account(report_, film_, entry_, 0, true).film, film / 4 * 9);
    EXPECT_EQ(memory_account(report_, film_, entry_).film, film / 4 * 5);
}

// 43 layers of three channels and a beauty in each of two films, 16 bytes each, and three quarters of one for writing.
TEST_F(Memory, CountsTheRecordOfTechniques)
{
    const uint64_t techniques = TechniqueRecord::bytes(film_);
    EXPECT_EQ(techniques, 100u * 10 * (43 + 1) * 3 * 16 * 11 / 4);
    check(program_bytes + 100000 + techniques, techniques);
    EXPECT_EQ(choice_.settings.integer("memory"), 100000 - 61500);
    try {
        check(program_bytes + 100000, techniques);
        ADD_FAILURE() << "the record of techniques is not refused";
    } catch (const UserError& error) {
        EXPECT_NE(std::string_view(error.what()).find("--techniques"), std::string_view::npos) << error.what();
    }
}

}  // namespace
}  // namespace dapple
