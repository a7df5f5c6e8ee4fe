// Names of annotation files: sparse ones for new sessions and upgraded projects, and what exists.

#include "engine/session/annotation_files.h"

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

fs::path project_in(const TemporaryFolder& folder, bool is_zarr)
{
    const fs::path project = folder.path / "p";
    fs::create_directories(project / "shvr");
    if (is_zarr) folder.write("p/.zattrs", "{}");
    return project;
}

Session session_of(const fs::path& mask, const fs::path& density)
{
    Session session;
    session.mask_path = mask;
    session.density_path = density;
    return session;
}

}  // namespace

TEST_CASE("files beside a mask have its name; those of a project's labels are in its folder shvr")
{
    const fs::path at = "/nowhere";
    CHECK(offsets_beside(at / "a.mask") == at / "a.offset");
    CHECK(offsets_beside(at / "a.tif") == at / "a.offset");
    CHECK(offsets_beside(at / "a.zarr") == at / "a.offsets.zarr");
    CHECK(offsets_beside(at / "a.labels.zarr") == at / "a.offsets.zarr");
    CHECK(offsets_beside(at / "labels" / "a") == at / "shvr" / "a.offsets.zarr");
    CHECK(trace_beside(at / "a.mask") == at / "a.graphml");
    CHECK(trace_beside(at / "a.labels.zarr") == at / "a.graphml");
    CHECK(trace_beside(at / "labels" / "a") == at / "shvr" / "a.graphml");
}

TEST_CASE("files that earlier versions put beside a label image are found")
{
    const TemporaryFolder folder;
    folder.write("a.offset", "");
    folder.write("a.labels.graphml", "");
    CHECK(offsets_beside(folder.path / "a.zarr") == folder.path / "a.offset");
    CHECK(trace_beside(folder.path / "a.labels.zarr") == folder.path / "a.labels.graphml");
}

TEST_CASE("a new session has a label image; a mask that is there already is kept")
{
    const TemporaryFolder folder;
    const fs::path session = folder.path / "scan.session.json";
    CHECK(mask_beside(session) == folder.path / "scan.session.labels.zarr");
    folder.write("scan.session.mask", "");
    CHECK(mask_beside(session) == folder.path / "scan.session.mask");
    fs::create_directory(folder.path / "scan.session.labels.zarr");
    CHECK(mask_beside(session) == folder.path / "scan.session.labels.zarr");
}

TEST_CASE("a project's .mask and .offset get sparse names that are free; files elsewhere keep theirs")
{
    for (const bool is_zarr : {true, false}) {
        const TemporaryFolder folder;
        const fs::path project = project_in(folder, is_zarr), file = project / "shvr" / "session.json";
        const fs::path shvr = project / "shvr";
        const auto names = sparse_names(session_of(shvr / "paint.mask", shvr / "paint.offset"), file);
        REQUIRE(names);
        const fs::path mask = is_zarr ? project / "labels" / "paint" : shvr / "paint.zarr";
        CHECK(names->mask == mask);
        CHECK(names->density == shvr / "paint.offsets.zarr");
        // Taken by others
        fs::create_directories(mask);
        CHECK(sparse_names(session_of(shvr / "paint.mask", {}), file)->mask.filename() ==
              (is_zarr ? "paint-2" : "paint-2.zarr"));
        CHECK_FALSE(sparse_names(session_of(mask, shvr / "paint.offsets.zarr"), file));
        CHECK_FALSE(sparse_names(session_of(folder.path / "paint.mask", folder.path / "a.offset"), file));
        CHECK_FALSE(sparse_names(session_of(shvr / "paint.tif", shvr / "a.nrrd"), file));
        CHECK_FALSE(sparse_names(session_of(folder.path / "a.mask", {}), folder.path / "a.json"));
        CHECK_FALSE(sparse_names({}, file));
        const auto offsets_alone = sparse_names(session_of(shvr / "paint.tif", shvr / "paint.offset"), file);
        CHECK(offsets_alone->mask == shvr / "paint.tif");
        CHECK(offsets_alone->density == shvr / "paint.offsets.zarr");
    }
}

TEST_CASE("new names are written into the session's text, where nothing else changes")
{
    const std::string text = with_names(R"({"shvr_session": 1, "cameras": {"a": 2}, "annotation": {"mask": "a.mask"}})",
                                        {"/p/labels/a", "/p/shvr/a.graphml", {}}, "/p/shvr/session.json");
    std::string packed;
    for (const char c : text)
        if (c != ' ' && c != '\n') packed += c;
    CHECK(packed == R"({"shvr_session":1,"cameras":{"a":2},"annotation":{"mask":"../labels/a","trace":"a.graphml"}})");
}
