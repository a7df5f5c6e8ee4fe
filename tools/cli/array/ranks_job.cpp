#include "tools/cli/array/ranks_job.h"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <string_view>
#include <utility>

#include "engine/base/atomic_writer.h"
#include "engine/ranks/picture_desk.h"
#include "engine/ranks/picture_worker.h"
#include "tools/cli/long_work.h"
#include "tools/cli/stop.h"

namespace shvr::cli {

namespace {

constexpr std::string_view SHARED_COMMAND = "render";

struct Job {
    std::unique_ptr<Ranks> ranks;
    bool have_all_ended = false;
    bool is_silent = false;
};
Job& job()
{
    static Job only;
    return only;
}

std::string host_name()
{
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "an unknown host";
}

/// Ends the process by the signal that has asked it to stop.
void end_at_once(const Ranks& ranks, const std::filesystem::path& output)
{
    remove_temporary_files();
    if (ranks.index() > 0) collect_temporary_files(output.parent_path());
    clear_progress();
    print_beside_progress(sentence("shvr: ", StopRequest::in_words(),
                                   ", which mpirun also sends when a rank is lost; no file is left half written"));
    std::signal(SIGTERM, SIG_DFL);
    ::kill(::getpid(), SIGTERM);
}

}  // namespace

void silence_other_ranks(int argc, char** argv)
{
    if (argc < 2 || argv[1] != SHARED_COMMAND || launched_rank() == 0) return;
    job().is_silent = true;
    const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nothing < 0) return;
    ::dup2(nothing, STDOUT_FILENO);
    ::dup2(nothing, STDERR_FILENO);
    ::close(nothing);
}

Ranks& join_ranks()
{
    if (!job().ranks) job().ranks = open_ranks();
    return *job().ranks;
}

void note_ranks_have_ended()
{
    job().have_all_ended = true;
}

bool leave_ranks(const std::string& failure)
{
    const std::unique_ptr<Ranks> ranks = std::exchange(job().ranks, nullptr);
    if (!ranks || ranks->count() == 1) return !job().is_silent;
    if (ranks->index() == 0) {
        if (!job().have_all_ended) end_other_ranks(*ranks);
    } else if (!failure.empty()) {
        PictureWorker(*ranks).end_failed(
            sentence(failure, " (rank ", ranks->index(), " of ", ranks->count(), ", on ", host_name(), ")"));
    }
    ranks->end();
    return ranks->index() == 0;
}

RanksWatch::RanksWatch(const Ranks& ranks, std::filesystem::path output)
    : thread_([&ranks, output = std::move(output)](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
              if (StopRequest::flag()) return end_at_once(ranks, output);
              std::this_thread::sleep_for(std::chrono::milliseconds(5));
          }
      })
{}

}  // namespace shvr::cli
