// What killed programs leave next to their outputs is removed by its owner and age; and where links lead.

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <set>
#include <string>

#include <doctest/doctest.h>

#include "engine/base/atomic_writer.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;
namespace fs = std::filesystem;

namespace {

/// A process that has ended and was waited for.
pid_t dead_process()
{
    const pid_t child = ::fork();
    if (child == 0) std::_Exit(0);
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    return child;
}

std::set<std::string> names_in(const fs::path& folder)
{
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
    return names;
}

}  // namespace

TEST_CASE("temporary files are collected by owner and age; a writer's own name says both")
{
    const TemporaryFolder folder;
    std::string host;
    {
        AtomicWriter writer(folder.path / "a.mask");
        const std::string name = *names_in(folder.path).begin();
        const std::string begin = ".shvr-" + std::to_string(::getpid()) + "-";
        REQUIRE(name.starts_with(begin));
        host = name.substr(name.find('-', begin.size()));  // "-HOST.tmp"
        collect_temporary_files(folder.path);              // which is being written
        CHECK(names_in(folder.path) == std::set{name});
        writer.commit();
    }
    CHECK(names_in(folder.path) == std::set<std::string>{"a.mask"});
    const std::string dead = std::to_string(dead_process()), mine = std::to_string(::getpid());
    const auto now = fs::file_time_type::clock::now();
    const auto make = [&](const std::string& name, std::chrono::hours age) {
        fs::last_write_time(folder.write(name, "x"), now - age);
    };
    constexpr std::chrono::hours NEW{0}, OLD{48};
    const std::set<std::string> stay{".shvr-" + mine + "-1" + host,
                                     ".shvr-" + mine + "-2" + host + ".bak",
                                     ".shvr-" + dead + "-1-another.tmp",
                                     ".shvr-" + dead + "-2.tmp",
                                     ".shvr-notes.tmp",
                                     ".shvr-" + dead + ".tmp",
                                     "shvr-" + dead + "-1" + host,
                                     "a.mask"};
    for (const std::string& name : stay) make(name, NEW);
    for (const std::string& name : {std::string(".shvr-notes.tmp"), ".shvr-" + dead + ".tmp"}) make(name, OLD);
    make(".shvr-" + dead + "-3" + host, NEW);
    make(".shvr-" + dead + "-3-another.tmp", OLD);
    make(".shvr-" + dead + "-3.tmp", OLD);  // as earlier versions name them
    fs::create_directory(folder.path / (".shvr-" + dead + "-4" + host));
    collect_temporary_files(folder.path);
    std::set<std::string> expected = stay;
    expected.insert(".shvr-" + dead + "-4" + host);
    CHECK(names_in(folder.path) == expected);
    collect_temporary_files(folder.path / "missing");
}

TEST_CASE("a link leads to its target, also one that is not there yet, and not round in circles")
{
    const TemporaryFolder folder;
    const fs::path base = fs::canonical(folder.path);
    fs::create_directory(base / "real");
    fs::create_directory_symlink(base / "real", base / "folder");
    fs::create_symlink("real/made.png", base / "dangling.png");
    fs::create_symlink("dangling.png", base / "twice.png");
    fs::create_symlink("circle", base / "circle");
    CHECK(link_target(base / "plain.png") == base / "plain.png");
    CHECK(link_target(base / "folder" / "a.png") == base / "real" / "a.png");
    CHECK(link_target(base / "dangling.png") == base / "real" / "made.png");
    CHECK(link_target(base / "twice.png") == base / "real" / "made.png");
    CHECK(link_target(base / "real" / ".." / "b.png") == base / "b.png");
    CHECK(link_target(base / "circle").filename() == "circle");
}
