#include "engine/pieces/pieces.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include <doctest/doctest.h>

#include "engine/base/atomic_file.h"
#include "engine/base/atomic_writer.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
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

/// A process that has ended and was waited for.
pid_t dead_process()
{
    const pid_t child = ::fork();
    if (child == 0) std::_Exit(0);
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    return child;
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

TEST_CASE("a damaged manifest is refused with the key, what it holds, what is expected, and what to do")
{
    const TemporaryFolder folder;
    const Pieces pieces = Pieces::of_output(folder.path / "out");
    pieces.begin(manifest_of(4));
    const std::string whole = read_text(pieces.manifest_path(), 1 << 20);
    const std::string file = pieces.manifest_path().string();
    const std::string remedy = ": remove this file, and run any task of the job again, which writes it again";
    const auto message_of = [&](const std::string& text) {
        folder.write("out.pieces/manifest.json", text);
        std::string message;
        try {
            static_cast<void>(pieces.manifest());
        } catch (const Error& error) {
            message = error.what();
        }
        CHECK(refusal_of(pieces, manifest_of(4)) == message);
        return message;
    };
    for (size_t bytes = 0; bytes < whole.size() - 2; bytes += 7) {
        const std::string message = message_of(whole.substr(0, bytes));
        CAPTURE(message);
        CHECK(message.starts_with(file + ": is not JSON: "));
        CHECK(message.ends_with("; expected what the first task wrote" + remedy));
        CHECK(std::ranges::count(message, '\n') == 0);
    }
    const auto with = [&](const std::string& before, const std::string& after) {
        const size_t at = whole.find(before);
        REQUIRE(at != std::string::npos);
        return std::string(whole).replace(at, before.size(), after);
    };
    const struct {
        std::string before, after, says;
    } cases[] = {
        {R"("tasks": 4)", R"("tasks": 0)", "key tasks is 0; expected a whole number from 1 to " + sentence(MAX_TASKS)},
        {R"("tasks": 4)", R"("tasks": "4")",
         R"(key tasks is "4"; expected a whole number from 1 to )" + sentence(MAX_TASKS)},
        {R"("tasks": 4)", R"("task": 4)", "key tasks is missing; expected the number of tasks"},
        {R"("shvr_pieces": 1)", R"("shvr_pieces": 2)", "key shvr_pieces is 2; expected 1"},
        {R"("version": "1")", R"("version": "")", R"(key version is ""; expected a text that is not empty)"},
        {R"("label",)", R"(7,)", "key command.0 is 7; expected a text"},
        {R"("folder": "/work")", R"("folder": "work")",
         R"(key folder is "work"; expected the path of a folder from the root, as in /data/scans)"},
        {R"("inputs": [)", R"("inputs": 1, "others": [)", "key inputs is 1; expected an array"},
        {whole, "[]", "key shvr_pieces is missing; expected 1, as shvr writes it"},
    };
    for (const auto& [before, after, says] : cases) {
        const std::string message = message_of(with(before, after));
        CAPTURE(message);
        CHECK(message.starts_with(file + ": " + says));
        CHECK(message.ends_with(remedy));
    }
    CHECK(message_of(R"({"shvr_pieces": 1, "version": "1", "command": [], "folder": "/", "tasks": 4, "inputs": []})")
              .find("key command is []; expected ") != std::string::npos);
    // What the message advises.
    std::filesystem::remove(pieces.manifest_path());
    pieces.begin(manifest_of(4));
    CHECK(read_text(pieces.manifest_path(), 1 << 20) == whole);
}

TEST_CASE("what killed tasks left is removed when a task begins, and what living ones write stays")
{
    const TemporaryFolder folder;
    const Pieces pieces = Pieces::of_output(folder.path / "out");
    pieces.begin(manifest_of(4));
    std::string host;
    {
        AtomicWriter writer(pieces.piece(0));
        for (const auto& entry : std::filesystem::directory_iterator(pieces.folder())) {
            const std::string name = entry.path().filename().string();
            if (name.starts_with(".shvr-")) host = name.substr(name.find('-', name.find('-', 6) + 1));  // "-HOST.tmp"
        }
    }
    REQUIRE(host.ends_with(".tmp"));
    const std::string dead = sentence(".shvr-", dead_process(), "-0", host);
    const std::string living = sentence(".shvr-", ::getpid(), "-900", host);
    const std::filesystem::path places[] = {"out.pieces", "out.pieces/piece-1.part", "out.pieces/piece-1.part/shvr"};
    std::filesystem::create_directories(folder.path / places[2]);
    for (const std::filesystem::path& place : places)
        for (const std::string& name : {dead, living, std::string(".shvr-lock")}) folder.write(place / name, "x");
    folder.write("out.pieces/.manifest-1-1", "a task that writes it now");
    folder.write("out.pieces/.manifest-2-2", "a task killed long ago");
    std::filesystem::last_write_time(pieces.folder() / ".manifest-2-2",
                                     std::filesystem::file_time_type::clock::now() - std::chrono::hours(48));
    std::filesystem::create_hard_link(pieces.manifest_path(), pieces.folder() / ".manifest-3-3");
    pieces.begin(manifest_of(4));
    for (const std::filesystem::path& place : places) {
        CAPTURE(place.string());
        CHECK_FALSE(std::filesystem::exists(folder.path / place / dead));
        CHECK(std::filesystem::exists(folder.path / place / living));
        CHECK(std::filesystem::exists(folder.path / place / ".shvr-lock"));
    }
    CHECK(std::filesystem::exists(pieces.folder() / ".manifest-1-1"));
    CHECK_FALSE(std::filesystem::exists(pieces.folder() / ".manifest-2-2"));
    CHECK_FALSE(std::filesystem::exists(pieces.folder() / ".manifest-3-3"));
    CHECK(pieces.manifest().tasks == 4);
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
