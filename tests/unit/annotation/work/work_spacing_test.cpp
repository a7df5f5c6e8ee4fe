// A spacing that is corrected: nodes stay at their voxels, now and in the whole history.

#include <doctest/doctest.h>

#include "engine/annotation/work/work.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

class Desk : public TemporaryFolder {
public:
    std::unique_ptr<Work> open(const glm::dvec3& spacing, const std::string& unit = "um", bool only_look = false) const
    {
        auto work = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
        WorkFiles files = files_in(path);
        files.volume.spacing = spacing;
        files.volume.unit = unit;
        said.clear();
        for (const Notice& notice : work->open(files, {.only_look = only_look})) said += notice.text + "\n";
        for (const Dispute& dispute : work->disputes()) said += dispute.text + "\n";
        return work;
    }
    mutable std::string said;
};

const glm::dvec3 ONE(1.0), OTHER(0.5, 2.0, 3.0);

TraceNode node_at(const glm::dvec3& voxel, double radius_voxels, const glm::dvec3& spacing)
{
    return {voxel * spacing, radius_voxels * spacing.x, 1};
}

void add(Work& work, uint32_t number, const TraceNode& node)
{
    work.perform({"node", {TraceChange(TraceNodeChange{number, {}, node})}});
}

}  // namespace

TEST_CASE("nodes stay at their voxels where the spacing is corrected, and so they do in the whole history")
{
    const Desk desk;
    const glm::dvec3 a(3.5, 4.25, 5.0), b(7.5, 8.0, 1.0), c(20.5, 1.0, 2.0);
    {
        const auto work = desk.open(ONE);
        add(*work, 0, node_at(a, 2.0, ONE));
        add(*work, 1, node_at(b, 3.0, ONE));
        work->perform({"radii", {TraceChange(TraceSizeChange{1, {}, 1.5})}});
        work->perform({"move", {TraceChange(TraceNodeChange{0, node_at(a, 2.0, ONE), node_at(c, 2.0, ONE)})}});
        work->save();
    }
    {
        const auto work = desk.open(OTHER, "mm", true);
        CHECK(
            contains(desk.said,
                     "a.journal: was traced with voxels of 1 x 1 x 1 \u00b5m; expected 0.5 x 2 x 3 mm, this volume's: "
                     "its nodes stay at their voxels, and lengths follow;"));
        CHECK((work->document().trace.node(0) == node_at(c, 2.0, OTHER)));
    }
    auto work = desk.open(OTHER, "mm");
    CHECK((work->document().trace.node(1) == node_at(b, 3.0, OTHER)));
    CHECK(work->document().trace.internode_radii().at(1) == 0.75);
    CHECK_FALSE(work->is_saved());  // the trace's file is in the other spacing
    work->undo();
    CHECK((work->document().trace.node(0) == node_at(a, 2.0, OTHER)));
    add(*work, 2, node_at(c, 1.0, OTHER));
    work->save();
    work.reset();
    // Once more, now with records of two spacings.
    CHECK(desk.open(OTHER, "mm")->is_saved());
    CHECK(desk.said.empty());
    const glm::dvec3 third(0.25, 0.5, 8.0);
    work = desk.open(third, "mm");
    CHECK(contains(desk.said, "was traced with voxels of 0.5 x 2 x 3 mm; expected 0.25 x 0.5 x 8 mm"));
    CHECK((work->document().trace.node(2) == node_at(c, 1.0, third)));
    work->undo();
    work->undo();
    CHECK(work->document().trace.internode_radii().empty());
    work->undo();
    CHECK(work->document().trace.nodes().size() == 1);
    CHECK((work->document().trace.node(0) == node_at(a, 2.0, third)));
    while (work->redo() != nullptr) continue;
    CHECK((work->document().trace.node(2) == node_at(c, 1.0, third)));
    // To the last save, which was of the spacing before.
    add(*work, 3, node_at(b, 1.0, third));
    REQUIRE(work->revert() != nullptr);
    CHECK(work->document().trace.nodes().size() == 3);
    CHECK((work->document().trace.node(0) == node_at(a, 2.0, third)));
    work.reset();
    work = desk.open(ONE);
    CHECK((work->document().trace.node(0) == node_at(a, 2.0, ONE)));
    CHECK((work->document().trace.node(2) == node_at(c, 1.0, ONE)));
}

TEST_CASE("random work in spacings that change between openings is one history, to the first step and to the last")
{
    const Desk desk;
    std::mt19937 random(4);
    std::vector<glm::dvec3> spacings{ONE, OTHER, glm::dvec3(0.1, 0.1, 0.3), glm::dvec3(4.0)};
    std::vector<uint64_t> masks;
    std::vector<size_t> nodes;
    for (int day = 0; day < 12; ++day) {
        const auto work = desk.open(spacings[size_t(day) % spacings.size()]);
        work->set_limits({.history_bytes = 2000, .bytes_between_states = 3000, .steps_between_states = 25});
        CHECK(!contains(desk.said, "cannot be taken"));
        for (int i = 0; i < 40; ++i) {
            Command command = random_tracing(work->document(), random);
            if (random() % 4 == 0) command = random_painting(work->document(), random);
            if (work->perform(std::move(command)) == nullptr) continue;
            masks.push_back(hash_of(work->document().mask));
            nodes.push_back(work->document().trace.nodes().size());
        }
        if (day % 3 == 0) work->save();
    }
    const auto work = desk.open(spacings[2]);
    CHECK(!contains(desk.said, "cannot be taken"));
    REQUIRE(work->history().undoable() == masks.size());
    size_t wrong = 0;
    for (size_t at = masks.size(); at-- > 0;) {
        wrong += hash_of(work->document().mask) != masks[at] || work->document().trace.nodes().size() != nodes[at];
        REQUIRE(work->undo() != nullptr);
    }
    CHECK(wrong == 0);
    CHECK(hash_of(work->document()) == hash_of(unannotated()));
    while (work->redo() != nullptr) continue;
    CHECK(work->document().trace.nodes().size() == nodes.back());
}

TEST_CASE("rounding is no other spacing, and a journal of an older program takes the one it is opened with")
{
    const Desk desk;
    {
        const auto work = desk.open({0.1, 0.2, 0.3});
        add(*work, 0, node_at({1.0, 2.0, 3.0}, 1.0, {0.1, 0.2, 0.3}));
        work->save();
    }
    const TraceNode before = desk.open({0.1, 0.2, 0.3})->document().trace.node(0);
    const auto work = desk.open({0.1 * (1.0 + 1e-12), 0.2, 0.3});
    CHECK(!contains(desk.said, "was traced"));
    CHECK((work->document().trace.node(0) == before));
}

TEST_CASE("a journal with two spacings is refused by programs that know one")
{
    const Desk desk;
    add(*desk.open(ONE), 0, node_at({1.0, 2.0, 3.0}, 1.0, ONE));
    add(*desk.open(OTHER), 1, node_at({1.0, 2.0, 4.0}, 1.0, OTHER));
    bool is_refused = false;
    for (const JournalRecord& record : scan_journal(files_in(desk.path).journal).records)
        is_refused = is_refused || (uint32_t(record.kind) > uint32_t(RecordKind::saved) &&
                                    uint32_t(record.kind) < FIRST_ADDITION);  // as they decide
    CHECK(is_refused);
}
