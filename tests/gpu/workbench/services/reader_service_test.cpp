// The reader alone: values under the probe, and distances between two visible points.

#include <doctest/doctest.h>

#include "engine/workbench/services/reader.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct ReaderAlone : DeskWithScan {
    std::optional<glm::dvec3> seen;
    Reader reader{desk,
                  keeper,
                  {.pointer = [] { return std::optional<Pointer>(); },
                   .pane = [this](size_t index) { return pane(index); },
                   .seen_at = [this](const Pane&, const glm::dvec2&) { return seen; },
                   .take_session = [this](Session session) { document().session = std::move(session); }}};
    Reading read()
    {
        later_s += 60.0;  // reading may be delayed
        reader.advance();
        return reader.model().reading;
    }
};

}  // namespace

TEST_CASE_FIXTURE(ReaderAlone, "reader: the voxel under the probe is read, and again when it is painted")
{
    CHECK(read().voxel == glm::dvec3(20, 18, 16));
    uint8_t voxel[2]{};
    document().source->read({{20, 18, 16}, {21, 19, 17}},
                            std::as_writable_bytes(std::span(voxel)).first(bytes_of(document().volume().type)));
    const double expected = bytes_of(document().volume().type) == 1 ? voxel[0] : voxel[0] + 256 * voxel[1];
    CHECK(read().intensity == expected);
    CHECK(read().group == 0);
    document().touch.place(paint());
    CHECK(read().group == document().brush().group);
    document().touch.place({-5.0, 18.0, 16.0});
    CHECK_FALSE(read().is_inside);
    CHECK_FALSE(read().intensity);
}

TEST_CASE_FIXTURE(ReaderAlone, "reader: two visible points are a distance, which can be copied and removed")
{
    const MeasureAt at{.pane = 0, .pixel = {1.0, 2.0}};
    CHECK(contains(error_of([&] { reader.act(at); }), "Nothing is seen there"));
    seen = glm::dvec3(4.0, 5.0, 6.0);
    reader.act(at);
    CHECK(document().session.measurements.empty());
    REQUIRE(reader.model().measuring.size() == 1);
    CHECK(reader.model().measuring[0] == *seen);
    reader.act(ClearMeasurements{});
    CHECK(reader.model().measuring.empty());
    reader.act(at);
    seen = glm::dvec3(4.0, 5.0, 16.0);
    reader.act(at);
    REQUIRE(document().session.measurements.size() == 1);
    CHECK(says("Distance 1: 10"));
    reader.act(CopyMeasurements{});
    CHECK(contains(reader.take_clipboard(), "10"));
    CHECK(reader.take_clipboard().empty());
    reader.act(ClearMeasurements{});
    CHECK(document().session.measurements.empty());
}
