#include "ui/browser.h"

#include <array>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace shvr::ui {

bool show_in_browser(const std::filesystem::path& page)
{
    // Starts the browser in a session of its own, so that Ctrl-C in this terminal does not end it, and without output
    // here, which may be JSON. The shell ends at once: waiting for it takes milliseconds and leaves no zombie.
    std::string shell = "sh", option = "-c", path = page.string();
    std::string script =
        "command -v xdg-open > /dev/null && exec setsid -f xdg-open \"$0\" < /dev/null > /dev/null 2>&1";
    const std::array<char*, 5> arguments{shell.data(), option.data(), script.data(), path.data(), nullptr};
    pid_t child = 0;
    if (posix_spawn(&child, "/bin/sh", nullptr, nullptr, arguments.data(), environ) != 0) return false;
    int status = 0;
    return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace shvr::ui
