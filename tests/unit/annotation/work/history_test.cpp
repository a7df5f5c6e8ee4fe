#include "engine/annotation/work/history.h"

#include <random>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/bounds.h"
#include "tests/support/random_annotation.h"
#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

namespace {

Command command_of(const std::string& label, MaskBrickChange change)
{
    Command command{label, {}};
    command.changes.emplace_back(std::move(change));
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

TEST_CASE("random operations: every state that undo or redo comes to is the one that was there")
{
    const size_t operations = repeats<size_t>(3000, 10'000);
    for (const uint32_t seed : {1u, 2u}) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        Document document = unannotated();
        History history;
        std::vector<uint64_t> states{hash_of(document)};  // after 0, 1, ... commands
        size_t at = 0, wrong = 0, performed = 0, painted_beside_locks = 0;
        for (size_t operation = 0; operation < operations; ++operation) {
            const auto choice = random() % 8;
            if (choice < 3) {
                at -= history.undo(document) != nullptr;
            } else if (choice < 5) {
                at += history.redo(document) != nullptr;
            } else {
                Command command = random_command(document, random);
                const GroupSet locked = locks_of(document);
                const std::array<int64_t, 256> voxels = document.mask.voxels_by_group();
                if (!command.changes.empty()) {
                    states.resize(++at);
                    ++performed;
                }
                history.perform(document, std::move(command));
                painted_beside_locks += locked.any() && voxels != document.mask.voxels_by_group();
                for (size_t group = 1; group < voxels.size(); ++group)
                    wrong += locked[group] && voxels[group] != document.mask.voxels_by_group()[group];
                if (states.size() == at) states.push_back(hash_of(document));
            }
            wrong += hash_of(document) != states[at] || history.undoable() != at ||
                     history.redoable() != states.size() - 1 - at;
        }
        check_below("states that differ", double(wrong), 0.0);
        CHECK(performed > operations * 3 / 10);
        CHECK(painted_beside_locks > operations / 40);

        while (history.redo(document)) ++at;
        CHECK(at == states.size() - 1);
        CHECK(hash_of(document) == states.back());
        while (history.undo(document)) wrong += hash_of(document) != states[--at];
        CHECK(at == 0);
        CHECK(wrong == 0);
        CHECK(document.mask.painted_bricks().empty());
        CHECK(document.density.painted_bricks().empty());
        CHECK(document.mask.voxels_by_group()[0] == ANNOTATED_SIZE.x * ANNOTATED_SIZE.y * ANNOTATED_SIZE.z);
    }
}
