#include "engine/movie/movie_encoder.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/machine/programs.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

constexpr const char *WEBM = ".webm", *MP4 = ".mp4";
constexpr int MOVIE_IN_FFMPEG = 3;  ///< the number that the movie's file has in ffmpeg
constexpr size_t PART_BYTES = size_t{1} << 20;

/// Opens a file without a name in `folder`, on whose disk the movie will lie.
int open_nameless(const fs::path& folder)
{
    const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file >= 0) return file;
    std::string name = (folder / ".shvr-movie-XXXXXX").string();  // where the file system has no O_TMPFILE
    const int named = ::mkostemp(name.data(), O_CLOEXEC);
    if (named >= 0) ::unlink(name.c_str());
    return named;
}

/// Returns the arguments of ffmpeg. Threads are counted and random or dated parts left out, so that one version of
/// ffmpeg writes the same bytes everywhere.
std::vector<std::string> arguments_of(bool is_webm, const glm::uvec2& size, double frames_per_second)
{
    std::vector<std::string> all{
        "ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-y",
        // frames on standard input, as rows of sRGB bytes
        "-f", "rawvideo", "-pixel_format", "rgba", "-video_size", sentence(size.x, 'x', size.y), "-framerate",
        digits_of(frames_per_second), "-i", "pipe:0",
        // the colours of HDTV, which players take for granted, with the curve of sRGB
        "-vf", "scale=out_color_matrix=bt709:out_range=tv:flags=bicubic+accurate_rnd+bitexact,format=yuv420p",
        "-color_range", "tv", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1",
        "-threads", "4", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1"};
    const std::vector<std::string> webm{"-c:v",      "libvpx-vp9", "-crf",      "18", "-b:v", "0",
                                        "-deadline", "good",       "-cpu-used", "2",  "-f",   "webm"};
    const std::vector<std::string> mp4{"-c:v",   "libx264",   "-crf",       "16", "-preset",
                                       "medium", "-movflags", "+faststart", "-f", "mp4"};
    const std::vector<std::string>& format = is_webm ? webm : mp4;
    all.insert(all.end(), format.begin(), format.end());
    all.push_back(sentence("/proc/self/fd/", MOVIE_IN_FFMPEG));
    return all;
}

/// Returns the status of an ended process; below 0: a signal ended it.
int wait_for(pid_t process)
{
    int status = 0;
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Returns the last line in a file without a name.
std::string last_line(const FileDescriptor& file)
{
    std::string text(4096, '\0');
    const off_t length = ::lseek(file.number(), 0, SEEK_END);
    const off_t begin = std::max<off_t>(length - off_t(text.size()), 0);
    const ssize_t count = ::pread(file.number(), text.data(), text.size(), begin);
    text.resize(count > 0 ? size_t(count) : 0);
    const std::string said(trimmed(text));
    return printable(said.substr(said.rfind('\n') + 1));
}

}  // namespace

bool is_movie_file(const fs::path& path)
{
    const std::string extension = lower_case(path.extension().string());
    return extension == WEBM || extension == MP4;
}

void check_movie_file(const fs::path& path, const glm::uvec2& size)
{
    if (!is_installed("ffmpeg"))
        fail(path.string(),
             ": the program ffmpeg is not installed; expected it for movies in one file: install the "
             "package ffmpeg, or give a folder for the frames as PNG files");
    if (size.x % 2 != 0 || size.y % 2 != 0)
        fail(path.string(), ": the frames have ", size.x, " x ", size.y,
             " pixels; expected even numbers for movies in one file");
}

MovieEncoder::MovieEncoder(const fs::path& path, const glm::uvec2& size, double frames_per_second)
    : path_(path),
      movie_(open_nameless(fs::absolute(path).parent_path())),
      complaints_(::memfd_create("ffmpeg", MFD_CLOEXEC))
{
    if (!movie_ || !complaints_) fail(path_.string(), ": cannot be written: ", reason_of(errno));
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        fail(path_.string(), ": ffmpeg cannot be given frames: ", reason_of(errno));
    frames_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    // ffmpeg's numbers must not be those of the originals, which are closed when it starts.
    const int copy = ::fcntl(movie_.number(), F_DUPFD_CLOEXEC, MOVIE_IN_FFMPEG + 1);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, complaints_.number(), STDERR_FILENO);
    posix_spawn_file_actions_adddup2(&actions, copy, MOVIE_IN_FFMPEG);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // Ctrl-C is for this program, which ends ffmpeg
    std::vector<std::string> texts =
        arguments_of(lower_case(path.extension().string()) == WEBM, size, frames_per_second);
    std::vector<char*> arguments;
    for (std::string& text : texts) arguments.push_back(text.data());
    arguments.push_back(nullptr);
    const int error = ::posix_spawnp(&process_, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    ::close(copy);
    if (error == 0) return;
    ::close(frames_);
    fail(path_.string(), ": the program ffmpeg cannot be started: ", reason_of(error));
}

MovieEncoder::~MovieEncoder()
{
    if (frames_ >= 0) ::close(frames_);
    if (process_ < 0) return;
    ::kill(process_, SIGKILL);
    wait_for(process_);
}

void MovieEncoder::refuse()
{
    const std::string said = last_line(complaints_);
    fail(path_.string(), ": ffmpeg could not write it: ", said.empty() ? "it ended without a reason" : said);
}

void MovieEncoder::add(const ImageF& rows)
{
    std::vector<uint8_t> bytes(rows.rgba.size());
    encode_pixels(rows.rgba, bytes);
    for (size_t sent = 0; sent < bytes.size();) {
        const ssize_t count = ::send(frames_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) {
            wait_for(std::exchange(process_, -1));
            refuse();
        }
        sent += size_t(count);
    }
}

void MovieEncoder::commit()
{
    ::close(std::exchange(frames_, -1));
    if (wait_for(std::exchange(process_, -1)) != 0) refuse();
    AtomicWriter writer(path_);
    std::vector<std::byte> part(PART_BYTES);
    for (off_t offset = 0;;) {
        const ssize_t count = ::pread(movie_.number(), part.data(), part.size(), offset);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path_.string(), ": cannot be written: ", reason_of(errno));
        if (count == 0) break;
        writer.append(std::span(part).first(size_t(count)));
        offset += count;
    }
    writer.commit();
}

}  // namespace shvr
