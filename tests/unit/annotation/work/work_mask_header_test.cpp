// What the header of a mask states and SHVR does not understand is kept by saves that do not simply replace the file.

#include <doctest/doctest.h>

#include "engine/annotation/files/mask_import.h"
#include "engine/annotation/files/mask_segments.h"
#include "engine/annotation/work/work.h"
#include "engine/session/label_looks.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

constexpr Size3 SIZE(4, 3, 2);
const std::string TERMS = "TerminologyEntry:Segmentation category^SCT^123037004|~^^";

VolumeInfo volume()
{
    return volume_of_size(SIZE, {1, 1, 2});
}

/// A segmentation of 3D Slicer with one voxel in group 1, whose terminology ends in `term`.
std::string segmentation(const std::string& term)
{
    std::string voxels(24, '\0');
    voxels[5] = 1;
    return "NRRD0004\n# a remark\ntype: uint8\ndimension: 3\nsizes: 4 3 2\nspacings: 1 1 2\nencoding: raw\n"
           "content: a root\nSegment3_ID:=Segment_xylem\nSegment3_LabelValue:=1\nSegment3_Name:=xylem\n"
           "Segment3_Tags:=" +
           TERMS + term + "\nsession:=a \\\\ b\n\n" + voxels;
}

Command paints(uint8_t group, uint16_t at)
{
    return {"paint", {MaskBrickChange{.brick = 0, .runs = {{at, at, 0, group}}}}};
}

std::unique_ptr<Work> opened(const WorkFiles& files)
{
    auto work = std::make_unique<Work>(SIZE, VoxelType::uint8);
    work->open(files);
    return work;
}

std::vector<LabelImage::Color> looks_of(const Work& work)
{
    return label_looks({{1, {.name = "xylem"}}}, work.document().mask);
}

bool states(const fs::path& file, const std::string& line)
{
    const std::string bytes = bytes_of_file(file);
    return contains(bytes.substr(0, bytes.find("\n\n") + 1), "\n" + line + "\n");
}

void check_kept(const fs::path& file, const std::string& term)
{
    CAPTURE(file);
    for (const char* line : {"# a remark", "content: a root", "Segment3_ID:=Segment_xylem", "session:=a \\\\ b"})
        CHECK_MESSAGE(states(file, line), line);
    CHECK(states(file, "Segment3_Tags:=" + TERMS + term));
    CHECK(states(file, "Segment4_LabelValue:=7"));
}

}  // namespace

// Kind (Masks): a segmentation that another program wrote while SHVR worked on it
TEST_CASE("a save that sets a segmentation aside keeps its terminology in the new file, too")
{
    const TemporaryFolder folder;
    const WorkFiles files{.journal = folder.path / "s.journal",
                          .mask = folder.write("s.seg.nrrd", segmentation("before")),
                          .volume = volume()};
    const auto work = opened(files);
    REQUIRE(work->perform(paints(7, 1)));
    work->save(looks_of(*work));
    check_kept(files.mask, "before");
    folder.write("s.seg.nrrd", segmentation("after"));
    REQUIRE(work->perform(paints(7, 2)));
    const Work::Saved saved = work->save(looks_of(*work));
    REQUIRE(saved.notices.size() == 1);
    CHECK(contains(saved.notices[0].text, "s.seg.nrrd.old"));
    CHECK(bytes_of_file(folder.path / "s.seg.nrrd.old") == segmentation("after"));
    check_kept(files.mask, "after");
}

// Kind (Masks): a segmentation that is saved under other names and formats, and exported from them
TEST_CASE("terminology of segments stays through names, label images and exports")
{
    const TemporaryFolder folder;
    const WorkFiles files{.journal = folder.path / "s.journal",
                          .mask = folder.write("s.seg.nrrd", segmentation("x")),
                          .volume = volume()};
    auto work = opened(files);
    REQUIRE(work->perform(paints(7, 1)));
    WorkFiles copy = files;
    copy.mask = folder.path / "copy.seg.nrrd";
    work->copier(looks_of(*work))(copy);
    check_kept(copy.mask, "x");
    WorkFiles moved{.journal = folder.path / "m.journal",
                    .mask = folder.path / "m.labels.zarr",
                    .trace = folder.path / "m.graphml",
                    .volume = volume()};
    work->save_as(moved, looks_of(*work));
    for (const bool again : {false, true}) {
        CAPTURE(again);
        work.reset();
        work = opened(moved);
        REQUIRE(work->perform(paints(7, again ? 3 : 2)));
        work->save(looks_of(*work));
        CHECK_FALSE(fs::exists(folder.path / "m.labels.zarr.old"));
        CHECK(work->mask_of_header() == moved.mask);
    }
    for (const char* name : {"e.seg.nrrd", "e.nrrd"}) {
        const fs::path exported = folder.path / name;
        save_mask_as(exported, work->document().mask, volume(),
                     {.colors = looks_of(*work), .header = mask_header(work->mask_of_header())});
        check_kept(exported, "x");
        CHECK(states(exported, "Segment3_Extent:=1 1 1 1 0 0"));
    }
    work->name_files(folder.path / "n.seg.nrrd", moved.trace, {});
    work->save(looks_of(*work));
    check_kept(folder.path / "n.seg.nrrd", "x");
    work->keep_header_of(folder.write("taken.seg.nrrd", segmentation("taken")));
    work->name_files(folder.path / "t.seg.nrrd", moved.trace, {});
    work->save(looks_of(*work));
    check_kept(folder.path / "t.seg.nrrd", "taken");
}

TEST_CASE("a header that is replaced gets only what it lacks; what is no header is none")
{
    const TemporaryFolder folder;
    const NrrdHead earlier = *nrrd_head_in(
        "NRRD0004\ndimension: 4\nSegment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Tags:=one\n"
        "Segment1_LabelValue:=1\nSegment1_Layer:=1\nSegment1_Tags:=two\nsession:=earlier\n");
    const fs::path file = folder.write("a.nrrd", "NRRD0005\nSegment8_LabelValue:=1\nSegment8_Name:=mine\n\n");
    const std::vector<std::string> lines = lines_of(*header_to_keep(file, earlier));
    CHECK(lines == std::vector<std::string>{"NRRD0005", "Segment8_LabelValue:=1", "Segment8_Name:=mine",
                                            "Segment8_Layer:=0", "Segment8_Tags:=one", "Segment9_LabelValue:=2",
                                            "Segment9_Layer:=0", "Segment9_Tags:=two"});
    std::string text;
    for (const std::string& line : lines_of(earlier)) text += line + "\n";
    CHECK(nrrd_head_in(text) == earlier);
    // Names of files follow a list alone; keys are escaped, too.
    const NrrdHead detached = *nrrd_head_in("NRRD0004\ndata file: a.raw\na \\\\ key:=x\ndata file: LIST\nb:=c\n");
    CHECK(detached.pairs == std::vector<NrrdPair>{{"a \\ key", "x"}});
    CHECK(lines_of(detached)[1] == "a \\\\ key:=x");
    CHECK(header_to_keep(folder.path / "missing.nrrd", earlier) == earlier);
    CHECK_FALSE(header_to_keep(folder.path / "missing.nrrd", {}));
    CHECK_FALSE(mask_header({}));
    CHECK_FALSE(mask_header(folder.write("a.mask", "raw")));
    fs::create_directories(folder.path / "broken.zarr");
    folder.write("broken.zarr/.zgroup", "{\"zarr_format\": 2}");
    for (const char* attributes : {"{\"shvr\": {\"nrrd_header\": 3}}", "{\"shvr\": {\"nrrd_header\": [1, 2]}}",
                                   "{\"shvr\": [", "{}", "{\"shvr\": {\"nrrd_header\": [\"MHD\"]}}"}) {
        folder.write("broken.zarr/.zattrs", attributes);
        CHECK_FALSE(mask_header(folder.path / "broken.zarr"));
    }
}
