#include "engine/annotation/writers/process.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <sstream>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {

namespace {

/// The first bytes of a file in /proc, whose files report no size; empty if the file cannot be read.
std::string text_of(const std::string& path)
{
    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    std::array<char, 1024> text{};
    const ssize_t count = file ? ::read(file.number(), text.data(), text.size()) : 0;
    return {text.data(), count > 0 ? size_t(count) : 0};
}

}  // namespace

std::string host_name()
{
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
}

std::string boot_name()
{
    // "1b4e28ba-2fa1-11d2-883f-0016d3cca427"
    constexpr size_t LENGTH = 36;
    const std::string text = text_of("/proc/sys/kernel/random/boot_id");
    return text.size() < LENGTH ? std::string() : text.substr(0, LENGTH);
}

uint64_t process_space()
{
    struct stat status {};
    return ::stat("/proc/self/ns/pid", &status) == 0 ? status.st_ino : 0;
}

std::optional<uint64_t> start_of(pid_t process)
{
    if (::kill(process, 0) != 0 && errno == ESRCH) return std::nullopt;
    const std::string text = text_of(sentence("/proc/", process, "/stat"));
    // proc(5): the name is in parentheses and may contain any character; the next field is the state.
    const size_t name_end = text.rfind(')');
    if (name_end == std::string::npos) return 0;
    constexpr size_t THREADS = 17, START = 19;
    std::istringstream words(text.substr(name_end + 1));
    std::vector<std::string> fields;
    for (std::string word; fields.size() <= START && words >> word;) fields.push_back(word);
    if (fields.size() <= START) return 0;
    // A process without other threads becomes a zombie after it has closed its files, so it counts as ended.
    if ((fields[0] == "Z" || fields[0] == "X") && fields[THREADS] <= "1") return std::nullopt;
    uint64_t start = 0;
    std::istringstream(fields[START]) >> start;
    return start;
}

bool is_on_local_disk(const std::filesystem::path& folder)
{
    // statfs(2)
    constexpr std::array<unsigned long, 7> LOCAL{0xEF53,       // ext2, ext3, ext4
                                                 0x58465342,   // XFS
                                                 0x9123683E,   // Btrfs
                                                 0xF2F52010,   // F2FS
                                                 0x2FC12FC1,   // ZFS
                                                 0x01021994,   // tmpfs
                                                 0x794C7630};  // overlayfs
    struct statfs status {};
    if (::statfs(folder.c_str(), &status) != 0) return false;
    return std::ranges::find(LOCAL, static_cast<unsigned long>(status.f_type)) != LOCAL.end();
}

}  // namespace shvr
