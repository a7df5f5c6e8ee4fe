#include "engine/base/machine/clipboard.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/machine/programs.h"

namespace shvr {

namespace {

bool is_wayland()
{
    const char* const display = std::getenv("WAYLAND_DISPLAY");
    return display && *display;
}

/// Runs a program with the file as its input, without output, and returns its status. It may go on in the background.
int run(const std::vector<std::string>& words, const std::filesystem::path& input)
{
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, input.c_str(), O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    pid_t process = -1;
    const int error = ::posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) fail("the program ", words[0], " cannot be started: ", reason_of(error));
    int status = 0;
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

ClipboardProgram clipboard_program()
{
    ClipboardProgram program =
        is_wayland() ? ClipboardProgram{"wl-copy", "wl-clipboard"} : ClipboardProgram{"xclip", "xclip"};
    program.is_installed = shvr::is_installed(program.name);
    return program;
}

void copy_png(const std::filesystem::path& file)
{
    const ClipboardProgram program = clipboard_program();
    if (!program.is_installed)
        fail("the picture cannot be copied without the program ", program.name, "; install the package ",
             program.package);
    const std::vector<std::string> words =
        program.name == "wl-copy"
            ? std::vector<std::string>{"wl-copy", "--type", "image/png"}
            : std::vector<std::string>{"xclip", "-selection", "clipboard", "-target", "image/png", "-in"};
    if (const int status = run(words, file); status != 0)
        fail("the picture could not be copied: ", program.name, " ended with status ", status,
             "; expected 0. Save the figure as a file instead");
}

std::filesystem::path path_for_clipboard()
{
    static std::atomic<int> count{0};
    return std::filesystem::temp_directory_path() / sentence("shvr-copy-", ::getpid(), '-', ++count, ".png");
}

}  // namespace shvr
