#include "engine/annotation/history.h"

#include <functional>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "engine/annotation/density_brush.h"

using namespace shvr;

namespace {

constexpr Size3 SIZE(45, 40, 35);  // no multiple of a brick's side

/// Differs (but for one chance in 2^64) where any group, or the set of bricks that exist, differs.
uint64_t hash_of(const Mask& mask)
{
    uint64_t hash = 0;
    for (const int64_t index : mask.painted_bricks()) {
        const MaskBrick& brick = *mask.brick(index);
        const std::string_view bytes(reinterpret_cast<const char*>(brick.data()), brick.size());
        hash = hash * 0x9e3779b97f4a7c15u + std::hash<std::string_view>()(bytes) + uint64_t(index);
    }
    return hash;
}

/// The same of offsets.
uint64_t hash_of(const DensityField& field)
{
    uint64_t hash = uint64_t(field.voxels());
    for (const int64_t index : field.painted_bricks()) {
        const OffsetBrick& brick = *field.brick(index);
        const std::string_view bytes(reinterpret_cast<const char*>(brick.data()), brick.size() * sizeof brick[0]);
        hash = hash * 0x9e3779b97f4a7c15u + std::hash<std::string_view>()(bytes) + uint64_t(index);
    }
    return hash;
}

uint64_t hash_of(const Document& document)
{
    return hash_of(document.mask) * 31 + hash_of(document.density);
}

Command command_of(const std::string& label, MaskBrickChange change)
{
    Command command{label, {}};
    command.changes.emplace_back(std::move(change));
    return command;
}

/// Paints or erases random parts of a random region: groups, offsets, or both in one command.
Command random_command(const Document& document, std::mt19937& random)
{
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    VoxelSelection selection(SIZE);
    const auto what = random() % 3;  // groups, offsets, both
    DensityStroke density(SIZE, {1, 1, 1.5}, VoxelType::int16, double(random() % 400) - 100.0,
                          random() % 2 == 0 ? Falloff::flat : Falloff::distance);
    for (auto dabs = 1 + random() % 3; dabs > 0; --dabs) {
        const auto shape = random() % 2 == 0 ? RegionShape::ball : RegionShape::box;
        const glm::dvec3 centre(uniform(-2, 47), uniform(-2, 42), uniform(-2, 37));
        const double radius = uniform(0.5, 6.0);
        const BrushRegion region = make_region(shape, centre, radius, {1, 1, 1.5}, SIZE);
        std::vector<uint32_t> words(size_t(region.words_per_row()) * region.rows.size());
        const auto share = random() % 3;
        for (uint32_t& word : words)
            word = share == 0 ? ~0u : share == 1 ? uint32_t(random()) : uint32_t(random() & random() & random());
        selection.add(region, words);
        density.add(region, words, centre, radius);
    }
    const auto group = uint8_t(random() % 3 == 0 ? 0 : random() % 256);
    Command command{"random", {}};
    if (what != 1) command.changes = paint_changes(document.mask, selection, group);
    if (what != 0)
        for (Change& change : density.changes(document.density)) command.changes.push_back(std::move(change));
    return command;
}

}  // namespace

TEST_CASE("commands are undone and redone in order")
{
    Document document{Mask({32, 32, 32})};
    History history;
    CHECK(history.undo(document) == nullptr);
    CHECK(history.redo(document) == nullptr);
    history.perform(document, command_of("one", {.brick = 0, .runs = {{0, 9, 0, 1}}}));
    history.perform(document, command_of("two", {.brick = 0, .runs = {{5, 9, 1, 2}}}));
    CHECK(document.mask.at({7, 0, 0}) == 2);
    CHECK(history.undoable() == 2);

    CHECK(history.undo(document)->label == "two");
    CHECK(document.mask.at({7, 0, 0}) == 1);
    CHECK(history.redoable() == 1);
    CHECK(history.redo(document)->label == "two");
    CHECK(document.mask.at({7, 0, 0}) == 2);
    CHECK(history.redo(document) == nullptr);

    CHECK(history.undo(document)->label == "two");
    CHECK(history.undo(document)->label == "one");
    CHECK(history.undo(document) == nullptr);
    CHECK(document.mask.painted_bricks().empty());
}

TEST_CASE("a new command drops what had been undone")
{
    Document document{Mask({32, 32, 32})};
    History history;
    history.perform(document, command_of("one", {.brick = 0, .runs = {{0, 9, 0, 1}}}));
    history.undo(document);
    history.perform(document, command_of("two", {.brick = 0, .runs = {{0, 9, 0, 2}}}));
    CHECK(history.redoable() == 0);
    CHECK(history.redo(document) == nullptr);
    CHECK(history.undoable() == 1);
    CHECK(document.mask.at({0, 0, 0}) == 2);
}

TEST_CASE("a command without changes is not recorded and drops nothing")
{
    Document document{Mask({32, 32, 32})};
    History history;
    history.perform(document, command_of("one", {.brick = 0, .runs = {{0, 9, 0, 1}}}));
    history.undo(document);
    history.perform(document, {"nothing", {}});
    CHECK(history.undoable() == 0);
    CHECK(history.redoable() == 1);
}

TEST_CASE("the changes of one command may build on each other")
{
    Document document{Mask({32, 32, 32})};
    History history;
    Command command = command_of("twice", {.brick = 0, .runs = {{0, 9, 0, 1}}});
    command.changes.emplace_back(MaskBrickChange{.brick = 0, .runs = {{3, 4, 1, 2}}});
    history.perform(document, std::move(command));
    CHECK(document.mask.at({3, 0, 0}) == 2);
    history.undo(document);
    CHECK(document.mask.painted_bricks().empty());
    history.redo(document);
    CHECK(document.mask.at({3, 0, 0}) == 2);
    CHECK(document.mask.at({5, 0, 0}) == 1);
}

TEST_CASE("10 000 random operations: every state that undo or redo comes to is the one that was there")
{
    for (const uint32_t seed : {1u, 2u}) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        Document document{.mask = Mask(SIZE), .trace = {}, .density = DensityField(SIZE, VoxelType::int16)};
        History history;
        std::vector<uint64_t> states{hash_of(document)};  // after 0, 1, ... commands
        size_t at = 0, wrong = 0, performed = 0;
        for (int operation = 0; operation < 10000; ++operation) {
            const auto choice = random() % 8;
            if (choice < 3) {
                at -= history.undo(document) != nullptr;
            } else if (choice < 5) {
                at += history.redo(document) != nullptr;
            } else {
                Command command = random_command(document, random);
                if (!command.changes.empty()) {
                    states.resize(++at);
                    ++performed;
                }
                history.perform(document, std::move(command));
                if (states.size() == at) states.push_back(hash_of(document));
            }
            wrong += hash_of(document) != states[at] || history.undoable() != at ||
                     history.redoable() != states.size() - 1 - at;
        }
        CHECK(wrong == 0);
        CHECK(performed > 3000);

        while (history.redo(document)) ++at;
        CHECK(at == states.size() - 1);
        CHECK(hash_of(document) == states.back());
        while (history.undo(document)) wrong += hash_of(document) != states[--at];
        CHECK(at == 0);
        CHECK(wrong == 0);
        CHECK(document.mask.painted_bricks().empty());
        CHECK(document.density.painted_bricks().empty());
        CHECK(document.mask.voxels_by_group()[0] == SIZE.x * SIZE.y * SIZE.z);
    }
}
