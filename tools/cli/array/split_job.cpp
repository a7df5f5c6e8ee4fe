#include "tools/cli/array/split_job.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "engine/base/text.h"

namespace shvr::cli {

namespace {

/// What `shvr gather` gives to --task.
constexpr const char* GATHER = "gather";

std::vector<std::string> arguments_given;
/// Of the manifest that shvr gather obeys; empty: none.
std::filesystem::path obeyed;

/// Options that concern one process, and may differ between the tasks of a job.
constexpr std::string_view OWN_OPTIONS[] = {"--task", "--threads", "--budget-host", "--budget-device"};
constexpr std::string_view OWN_FLAGS[] = {"--json", "--quiet"};

std::vector<std::string> arguments_of_job()
{
    std::vector<std::string> kept;
    for (size_t i = 0; i < arguments_given.size(); ++i) {
        const std::string& argument = arguments_given[i];
        const std::string_view name = std::string_view(argument).substr(0, argument.find('='));
        if (std::ranges::find(OWN_FLAGS, argument) != std::end(OWN_FLAGS)) continue;
        if (std::ranges::find(OWN_OPTIONS, name) == std::end(OWN_OPTIONS))
            kept.push_back(argument);
        else if (name.size() == argument.size())
            ++i;  // the value is the next argument
    }
    return kept;
}

}  // namespace

void note_arguments(const std::vector<std::string>& arguments)
{
    arguments_given = arguments;
}

void add_task_option(CLI::App& command, std::string& task)
{
    command
        .add_option("--task", task,
                    "Make the piece of task I of N alone, from 0 on, or of this task of a Slurm job array; shvr gather "
                    "joins the pieces, which lie in OUTPUT.pieces")
        ->type_name("I/N|slurm");
}

SplitJob::SplitJob(const std::string& task, const std::filesystem::path& output, const Common& common)
    : common_(common), pieces_(Pieces::of_output(task.empty() ? "-" : output))
{
    if (task.empty()) return;
    mode_ = task == GATHER ? Mode::gather : Mode::task;
    if (!obeyed.empty() && pieces_.folder() != obeyed)
        fail(obeyed.string(), ": its command writes ", output.string(), ", with pieces in ", pieces_.folder().string(),
             "; expected the pieces of that output where its tasks left them");
    choice_ = gathers() ? TaskChoice{0, pieces_.manifest().tasks} : task_choice(task, ::getenv);
}

void SplitJob::begin(const std::vector<std::filesystem::path>& inputs)
{
    if (!is_split()) return;
    if (gathers()) pieces_.expect_all(of());
    if (gathers() && inputs.empty()) return;
    PieceManifest manifest{.version = version_in_words(),
                           .command = arguments_of_job(),
                           .folder = std::filesystem::current_path(),
                           .tasks = choice_.of};
    for (const std::filesystem::path& path : inputs)
        for (const std::string& line : input_signatures(path)) manifest.inputs.push_back(line);
    pieces_.begin(manifest);
}

std::vector<std::filesystem::path> SplitJob::all_pieces() const
{
    std::vector<std::filesystem::path> paths;
    for (int64_t task = 0; task < of(); ++task) paths.push_back(piece(task));
    return paths;
}

void SplitJob::report() const
{
    const std::vector<std::string> missing = pieces_.missing(of());
    if (common_.json)
        return print({{"task", choice_.in_words()},
                      {"pieces", of()},
                      {"missing", missing},
                      {"path", piece().string()},
                      {"manifest", pieces_.manifest_path().string()}});
    say(common_, sentence(piece().string(), ": the piece of task ", choice_.in_words(), "; ",
                          missing.empty() ? sentence("all are there: shvr gather ", pieces_.manifest_path().string())
                                          : sentence(missing.size(), " of ", of(), " pieces are missing")));
}

void run_command(const std::vector<std::string>& arguments, const std::filesystem::path& pieces,
                 const std::function<void(const Json&)>& take)
{
    struct Restored {
        ~Restored()
        {
            obeyed.clear();
            divert_prints({});
        }
    } restored;
    obeyed = pieces;
    divert_prints(take);
    parse_and_run(arguments);
}

std::vector<std::filesystem::path> inputs_of(const std::filesystem::path& path, const Session& session)
{
    std::vector<std::filesystem::path> inputs{path};
    for (const std::filesystem::path& file :
         {session.volume_path, session.journal_path, session.mask_path, session.trace_path, session.density_path})
        if (!file.empty() && file != path && std::ranges::find(inputs, file) == inputs.end()) inputs.push_back(file);
    return inputs;
}

}  // namespace shvr::cli
