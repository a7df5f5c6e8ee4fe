#include "engine/pieces/pieces.h"

#include <thread>

#include <doctest/doctest.h>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using test::TemporaryFolder;

namespace {

PieceManifest manifest_of(int64_t tasks)
{
    return {.version = "1",
            .command = {"label", "scan", "-o", "out"},
            .folder = "/work",
            .tasks = tasks,
            .inputs = {"scan 7 1.5"}};
}

void put_piece(const Pieces& pieces, int64_t task)
{
    const std::string text = "piece";
    write_file_atomically(pieces.piece(task), std::as_bytes(std::span(text)));
}

std::string refusal_of(const Pieces& pieces, const PieceManifest& manifest)
{
    try {
        pieces.begin(manifest);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("the first task writes the manifest, and all others must agree with it")
{
    const TemporaryFolder folder;
    const Pieces pieces = Pieces::of_output(folder.path / "out");
    CHECK(pieces.folder() == folder.path / "out.pieces");
    pieces.begin(manifest_of(4));
    pieces.begin(manifest_of(4));
    const PieceManifest read = Pieces::of_manifest(pieces.manifest_path()).manifest();
    CHECK(read.tasks == 4);
    CHECK(read.command == manifest_of(4).command);
    CHECK(read.inputs == manifest_of(4).inputs);
    CHECK(refusal_of(pieces, manifest_of(5)).find("split into 4 tasks, and this is one of 5") != std::string::npos);
    const auto changed = [](auto change) {
        PieceManifest manifest = manifest_of(4);
        change(manifest);
        return manifest;
    };
    CHECK(refusal_of(pieces, changed([](auto& m) { m.version = "2"; })).find("shvr 1") != std::string::npos);
    CHECK(refusal_of(pieces, changed([](auto& m) { m.command.back() = "b"; })).find("-o b") != std::string::npos);
    CHECK(refusal_of(pieces, changed([](auto& m) { m.folder = "/b"; })).find("/b") != std::string::npos);
    CHECK(refusal_of(pieces, changed([](auto& m) { m.inputs = {"scan 7 2.0"}; })).find("2.0") != std::string::npos);
    CHECK(refusal_of(pieces, changed([](auto& m) { m.inputs = {}; })).find("nothing more") != std::string::npos);
}

TEST_CASE("a job is found by its output, its folder or its manifest; without one, the output's own manifest is missing")
{
    const TemporaryFolder folder;
    const std::filesystem::path output = folder.path / "out", pieces = folder.path / "out.pieces";
    const auto found = [](const std::filesystem::path& name) { return Pieces::of_manifest(name).folder(); };
    for (const bool is_there : {false, true}) {
        if (is_there) Pieces::of_output(output).begin(manifest_of(4));
        CHECK(found(output) == pieces);
        CHECK(found(output / "") == pieces);
        CHECK(found(pieces) == pieces);
        CHECK(found(pieces / "") == pieces);
        CHECK(found(pieces / "manifest.json") == pieces);
    }
    // An output that was made by one process, and pieces that were renamed.
    std::filesystem::create_directory(folder.path / "project");
    CHECK(found(folder.path / "project") == folder.path / "project.pieces");
    std::filesystem::rename(pieces, folder.path / "kept");
    CHECK(found(folder.path / "kept") == folder.path / "kept");
    CHECK(found(folder.path / "kept" / "manifest.json") == folder.path / "kept");
}

TEST_CASE("missing pieces are named, and pieces count once they are there")
{
    const TemporaryFolder folder;
    const Pieces pieces = Pieces::of_output(folder.path / "out");
    pieces.begin(manifest_of(3));
    put_piece(pieces, 1);
    put_piece(pieces, 1);
    CHECK(pieces.missing(3) == std::vector<std::string>{"0/3", "2/3"});
    CHECK_THROWS_AS(pieces.expect_all(3), MissingPieces);
    put_piece(pieces, 0);
    put_piece(pieces, 2);
    pieces.expect_all(3);
    pieces.remove();
    CHECK_FALSE(std::filesystem::exists(pieces.folder()));
    CHECK_THROWS_AS(pieces.manifest(), Error);
}

TEST_CASE("tasks that begin at once agree on one manifest, and leave nothing else")
{
    const TemporaryFolder folder;
    const Pieces pieces = Pieces::of_output(folder.path / "out");
    {
        std::vector<std::jthread> tasks;
        for (int i = 0; i < 8; ++i) tasks.emplace_back([&] { pieces.begin(manifest_of(8)); });
    }
    CHECK(pieces.manifest().tasks == 8);
    const std::filesystem::directory_iterator entries(pieces.folder());
    CHECK(std::distance(begin(entries), end(entries)) == 1);
}

TEST_CASE("a file's signature changes when it is written, and an address is its own")
{
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path / "scan";
    std::string text = "voxels";
    write_file_atomically(file, std::as_bytes(std::span(text)));
    const std::vector<std::string> of_file = input_signatures(file), of_folder = input_signatures(folder.path);
    CHECK(of_file == of_folder);
    text += "!";
    write_file_atomically(file, std::as_bytes(std::span(text)));
    CHECK(input_signatures(file) != of_file);
    CHECK(input_signatures("https://host/x.zarr") == std::vector<std::string>{"https://host/x.zarr"});
    CHECK(input_signatures({}).empty());
}
