#include "engine/base/file.h"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <span>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"

using namespace shvr;
namespace fs = std::filesystem;

namespace {

/// An empty folder for one test.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("shvr file test " + std::to_string(::getpid()));

    Folder()
    {
        fs::remove_all(path);
        fs::create_directory(path);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() { fs::remove_all(path); }

    auto entries() const { return std::distance(fs::directory_iterator(path), fs::directory_iterator()); }
};

/// Files of this process cannot grow beyond `bytes`: a disk that fills up in the middle of a write.
struct FullDisk {
    explicit FullDisk(rlim_t bytes)
    {
        ::getrlimit(RLIMIT_FSIZE, &old_limit);
        const rlimit limit{bytes, old_limit.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;
    ~FullDisk()
    {
        ::setrlimit(RLIMIT_FSIZE, &old_limit);
        std::signal(SIGXFSZ, old_handler);
    }

    void (*old_handler)(int) = std::signal(SIGXFSZ, SIG_IGN);
    rlimit old_limit{};
};

void put(const fs::path& path, const std::string& text)
{
    write_file_atomically(path, std::as_bytes(std::span(text)));
}

std::string refusal(const std::function<void()>& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "(none)";
}

constexpr int64_t KIB = 1024;

}  // namespace

TEST_CASE("a file is read whole")
{
    const Folder folder;
    const fs::path path = folder.path / "a b";
    const std::string text("line\r\n\0\xff end", 12);
    std::ofstream(path, std::ios::binary) << text;
    CHECK(read_text(path, KIB) == text);
    CHECK(read_text(path, 12) == text);
    const std::vector<std::byte> bytes = read_file(path, KIB);
    CHECK(std::ranges::equal(bytes, std::as_bytes(std::span(text))));
    std::ofstream(path, std::ios::trunc).flush();
    CHECK(read_text(path, 0).empty());
}

TEST_CASE("what cannot be read as a file is refused in words")
{
    const Folder folder;
    const std::string pipe = (folder.path / "pipe").string(), missing = (folder.path / "missing").string();
    const auto reason = [](const std::string& path) { return refusal([&] { read_file(path, KIB); }); };
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    CHECK(reason(pipe) == pipe + ": is a pipe; expected a file");
    CHECK(reason("/dev/zero") == "/dev/zero: is a device; expected a file");
    CHECK(reason(folder.path.string()) == folder.path.string() + ": is a folder; expected a file");
    CHECK(reason(missing) == missing + ": cannot be opened: No such file or directory");
    fs::create_symlink("/dev/zero", folder.path / "link");
    CHECK(reason((folder.path / "link").string()).ends_with(": is a device; expected a file"));
}

TEST_CASE("a file above the limit is refused by its size alone")
{
    const Folder folder;
    const fs::path path = folder.path / "sparse";
    std::ofstream(path).flush();
    fs::resize_file(path, uintmax_t{1} << 40);
    CHECK(refusal([&] { read_text(path, KIB); }) ==
          path.string() + ": holds 1099511627776 bytes; expected at most 1024");
}

TEST_CASE("saving makes a file or replaces one, and leaves nothing else")
{
    const Folder folder;
    const fs::path path = folder.path / "saved";
    put(path, "first");
    CHECK(read_text(path, KIB) == "first");
    put(path, "");
    CHECK(read_text(path, KIB).empty());
    const std::string large(5'000'000, 'x');
    put(path, large);
    CHECK(read_text(path, 5'000'000) == large);
    CHECK(folder.entries() == 1);
}

TEST_CASE("saving takes names that are relative or as long as names can be")
{
    const Folder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path);
    const std::string reason = refusal([&] {
        put("relative", "content");
        put(std::string(255, 'n'), "content");
    });
    fs::current_path(before);
    CHECK(reason == "(none)");
    CHECK(read_text(folder.path / "relative", KIB) == "content");
    CHECK(folder.entries() == 2);
}

TEST_CASE("saving keeps the permissions of the file it replaces")
{
    const Folder folder;
    const fs::path path = folder.path / "secret";
    put(path, "old");
    fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
    put(path, "new");
    CHECK(fs::status(path).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("saving replaces a symbolic link and does not follow it")
{
    const Folder folder;
    put(folder.path / "target", "target");
    fs::create_symlink("target", folder.path / "link");
    put(folder.path / "link", "new");
    CHECK(read_text(folder.path / "target", KIB) == "target");
    CHECK(read_text(folder.path / "link", KIB) == "new");
    CHECK_FALSE(fs::is_symlink(folder.path / "link"));
}

TEST_CASE("saving where it cannot be fails with path and reason and leaves nothing behind")
{
    const Folder folder;
    const std::string inside = (folder.path / "missing" / "file").string();
    CHECK(refusal([&] { put(inside, "x"); }) == inside + ": cannot be written: No such file or directory");
    fs::create_directory(folder.path / "occupied");
    const std::string occupied = (folder.path / "occupied").string();
    CHECK(refusal([&] { put(occupied, "x"); }) == occupied + ": cannot be written: Is a directory");
    const std::string too_long = (folder.path / std::string(256, 'n')).string();
    CHECK(refusal([&] { put(too_long, "x"); }) == too_long + ": cannot be written: File name too long");
    CHECK(refusal([&] { put("/dev/null", "x"); }) ==
          "/dev/null: is a device, pipe or socket; expected a file or nothing");
    CHECK(fs::is_character_file("/dev/null"));
    CHECK(refusal([&] { put("", "x"); }) == "'': cannot be written; expected the name of a file");
    CHECK(folder.entries() == 1);
}

TEST_CASE("a disk that fills up while saving leaves the old file as it was")
{
    const Folder folder;
    const fs::path path = folder.path / "saved";
    put(path, "old content");
    const std::string large(100'000, 'x');
    std::string reason;
    {
        const FullDisk full(10'000);
        reason = refusal([&] { put(path, large); });
    }
    CHECK(reason == path.string() + ": cannot be written: File too large");
    CHECK(read_text(path, KIB) == "old content");
    CHECK(folder.entries() == 1);
    put(path, large);
    CHECK(read_text(path, 100'000) == large);
}
