#include "ui/files/annotation_beside.h"

#include <chrono>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

TEST_CASE("annotation beside a scan is found by its names, the newest first, without what the session has")
{
    const TemporaryFolder folder;
    const auto now = std::filesystem::file_time_type::clock::now();
    int age = 0;
    for (const char* name : {"leaf-mask.nrrd", "traced.swc", "leaf.tif", "own.mask", "Labels.tif", "notes.txt",
                             "tubes-mask.nhdr", "tubes-mask.raw", "tubes.nhdr", "brain_label.nii", "a-labels.mha"}) {
        folder.write(name, "12345");
        std::filesystem::last_write_time(folder.path / name, now - std::chrono::minutes(++age));
    }
    std::filesystem::create_directory(folder.path / "mask.zarr");  // holds no image
    std::vector<std::string> names;
    for (const FoundFile& file : annotation_beside(folder.path, {folder.path / "own.mask"})) {
        names.push_back(file.name);
        CHECK(file.path == folder.path / file.name);
        CHECK(file.about == "5 B");
    }
    CHECK(names == std::vector<std::string>{"leaf-mask.nrrd", "traced.swc", "Labels.tif", "tubes-mask.nhdr",
                                            "brain_label.nii", "a-labels.mha"});
    CHECK(annotation_beside(folder.path / "gone", {}).empty());
    // Those of the open scan come first, whatever their age.
    CHECK(annotation_beside(folder.path, {}, {"", "tubes"}).front().name == "tubes-mask.nhdr");
    CHECK(annotation_beside(folder.path, {}, {"tube", "brain"}).front().name == "brain_label.nii");
}

TEST_CASE("what is at a path is a file, a folder that holds an image, another folder, or nothing")
{
    const TemporaryFolder folder;
    folder.write("a.swc", "");
    std::filesystem::create_directory(folder.path / "image");
    CHECK(what_is_at(folder.path / "image") == There::folder);
    folder.write("image/.zattrs", "{}");
    CHECK(what_is_at(folder.path / "image") == There::file);
    CHECK(what_is_at(folder.path / "a.swc") == There::file);
    CHECK(what_is_at(folder.path) == There::folder);
    CHECK(what_is_at(folder.path / "b.swc") == There::nothing);
}
