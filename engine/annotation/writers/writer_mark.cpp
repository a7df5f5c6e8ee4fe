#include "engine/annotation/writers/writer_mark.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>

#include "engine/annotation/writers/holder_text.h"
#include "engine/annotation/writers/process.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view SUFFIX = ".lock", REVOKED = ".revoked.lock";
constexpr size_t MAX_MARK_BYTES = 4096;
constexpr size_t MAX_HOST_BYTES = 32;
/// Leaves room for the other parts of a mark's name within the 255 bytes that file systems allow.
constexpr size_t MAX_NAME_BYTES = 120;

fs::path folder_of(const fs::path& journal)
{
    return journal.has_parent_path() ? journal.parent_path() : fs::path(".");
}

/// The start of the names of a journal's marks. A long journal name is cut, and its checksum (FNV-1a) appended.
std::string beginning_of(const fs::path& journal)
{
    const std::string name = journal.filename().string();
    if (name.size() <= MAX_NAME_BYTES) return name + ".";
    uint64_t sum = 14695981039346656037u;
    for (const char byte : name) sum = (sum ^ uint8_t(byte)) * 1099511628211u;
    return sentence(name.substr(0, MAX_NAME_BYTES), "-", sum, ".");
}

std::string plain_host()
{
    std::string host = host_name().substr(0, MAX_HOST_BYTES);
    for (char& byte : host)
        if (std::isalnum(static_cast<unsigned char>(byte)) == 0 && byte != '-') byte = '_';
    return host.empty() ? "unnamed" : host;
}

/// The first part of `boot_name`, which is random.
std::string plain_boot()
{
    const std::string boot = boot_name();
    return boot.substr(0, std::min(boot.find('-'), boot.size()));
}

uint64_t inode_of(const fs::path& folder)
{
    struct stat status {};
    return ::stat(folder.c_str(), &status) == 0 ? status.st_ino : 0;
}

/// The parts of a mark's name, which identify its owner.
struct Name {
    std::string host, process, boot, space, start, folder;
};

std::optional<Name> parse(std::string_view middle)
{
    std::vector<std::string> parts;
    while (!middle.empty()) {
        const size_t dot = std::min(middle.find('.'), middle.size());
        parts.emplace_back(middle.substr(0, dot));
        middle.remove_prefix(std::min(dot + 1, middle.size()));
    }
    constexpr size_t PARTS = 7;  // parts of a mark's name; the last is a count that makes names unique
    if (parts.size() != PARTS) return std::nullopt;
    for (const size_t number : {1u, 3u, 4u, 5u, 6u})
        if (!whole_of(parts[number])) return std::nullopt;
    return Name{parts[0], parts[1], parts[2], parts[3], parts[4], parts[5]};
}

WriterMark::Owner owner_of(const Name& name, const fs::path& folder)
{
    using enum WriterMark::Owner;
    if (name.host != plain_host()) return unknown;
    const bool is_local = is_on_local_disk(folder);
    // If the folder was copied, its marks are copies, too: their names state the inode of the original folder.
    if (is_local && name.folder != sentence(inode_of(folder))) return ended;
    const std::string boot = plain_boot(), space = sentence(process_space());
    if (boot.empty() || name.boot.empty() || space == "0") return unknown;
    if (name.boot != boot) return is_local ? ended : unknown;
    if (name.space != space) return unknown;
    const std::optional<uint64_t> start = start_of(pid_t(whole_of(name.process).value_or(0)));
    if (!start) return ended;
    return *start == 0 || sentence(*start) == name.start ? running : ended;
}

std::string time_of(const fs::path& mark)
{
    struct stat status {};
    return ::lstat(mark.c_str(), &status) == 0 ? time_in_words(status.st_mtim.tv_sec) : std::string();
}

/// Reads a mark; null if the file has been removed meanwhile.
std::optional<WriterMark> read_mark(const fs::path& path, const Name& name, const fs::path& folder)
{
    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
    if (!file && errno == ENOENT) return std::nullopt;
    std::string text(MAX_MARK_BYTES, '\0');
    const ssize_t count = file ? ::pread(file.number(), text.data(), text.size(), 0) : 0;
    text.resize(count > 0 ? size_t(count) : 0);
    WriterMark mark{.path = path, .owner = owner_of(name, folder), .holder = parse_holder(text)};
    mark.is_described = !mark.holder.process.empty();
    if (!mark.is_described) mark.holder = {.process = name.process, .host = name.host, .since = time_of(path)};
    mark.holder.may_have_ended = mark.owner == WriterMark::Owner::unknown;
    return mark;
}

}  // namespace

std::optional<fs::path> make_mark(const fs::path& journal, int& error)
{
    static std::atomic<unsigned> count = 0;
    const fs::path folder = folder_of(journal);
    for (;;) {
        fs::path mark = folder / sentence(beginning_of(journal), plain_host(), ".", ::getpid(), ".", plain_boot(), ".",
                                          process_space(), ".", start_of(::getpid()).value_or(0), ".", inode_of(folder),
                                          ".", count++, SUFFIX);
        const FileDescriptor file(::open(mark.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
        if (file) return mark;
        error = errno;
        if (error != EEXIST && error != EINTR) return std::nullopt;
    }
}

void describe_mark(const fs::path& mark, const Holder& holder)
{
    const FileDescriptor file(::open(mark.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW));
    const std::string text = to_text(holder);
    static_cast<void>(file && ::pwrite(file.number(), text.data(), text.size(), 0) > 0);
}

std::optional<std::vector<WriterMark>> marks_of(const fs::path& journal, const fs::path& own)
{
    const std::string beginning = beginning_of(journal);
    const fs::path folder = folder_of(journal);
    std::vector<WriterMark> marks;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        const std::string file = entry->path().filename().string();
        if (!file.starts_with(beginning) || !file.ends_with(SUFFIX) || file == own.filename().string()) continue;
        std::string_view middle = std::string_view(file).substr(beginning.size());
        middle.remove_suffix(std::min(middle.size(), (file.ends_with(REVOKED) ? REVOKED : SUFFIX).size()));
        const std::optional<Name> name = parse(middle);
        if (!name) continue;
        if (std::optional<WriterMark> mark = read_mark(folder / file, *name, folder)) marks.push_back(std::move(*mark));
    }
    if (error) return std::nullopt;
    return marks;
}

fs::path revoked(const fs::path& mark)
{
    const std::string name = mark.filename().string();
    if (name.ends_with(REVOKED)) return mark;
    return mark.parent_path() / (name.substr(0, name.size() - SUFFIX.size()) + std::string(REVOKED));
}

}  // namespace shvr
