// shvr gather: joins the pieces of a job that was split with --task. Runs the job's command again in this process,
// which then reads pieces instead of making them.

#include "tools/cli/array/split_job.h"

#include "engine/base/text.h"

namespace shvr::cli {

namespace {

namespace fs = std::filesystem;

struct GatherCommandOptions {
    Common common;
    std::vector<std::string> manifests;
    bool removes = false;
};

/// The working folder of the process while the object lives.
class WorkingFolder {
public:
    explicit WorkingFolder(const fs::path& folder) : before_(fs::current_path())
    {
        std::error_code error;
        fs::current_path(folder, error);
        if (error) fail(folder.string(), ": cannot be entered: ", error.message());
    }
    ~WorkingFolder()
    {
        std::error_code ignored;
        fs::current_path(before_, ignored);
    }
    WorkingFolder(const WorkingFolder&) = delete;

private:
    fs::path before_;
};

/// Removes "NAME.pieces" from a path's end.
fs::path output_of(const Pieces& pieces)
{
    return pieces.folder().parent_path() / pieces.folder().stem();
}

/// `printed`: what the command prints, also if it then fails.
void gather(const Pieces& pieces, const PieceManifest& manifest, const Common& common, Json& printed)
{
    std::vector<std::string> arguments = manifest.command;
    arguments.insert(arguments.end(), {"--task", "gather", "--json"});
    if (common.quiet) arguments.emplace_back("--quiet");
    if (common.threads > 0) arguments.insert(arguments.end(), {"--threads", std::to_string(common.threads)});
    const WorkingFolder there(manifest.folder);
    run_command(arguments, pieces.folder(), [&](const Json& result) { printed = result; });
}

void run_gather(const GatherCommandOptions& options)
{
    Json jobs = Json::array(), missing = Json::array();
    int64_t count = 0;
    std::string failure;
    std::optional<std::string> gate;
    for (const std::string& path : options.manifests) {
        const Pieces pieces = Pieces::of_manifest(path);
        pieces.collect_temporary();
        const PieceManifest manifest = pieces.manifest();
        count += manifest.tasks;
        Json job{{"pieces", manifest.tasks}, {"missing", Json::array()}, {"path", output_of(pieces).string()}};
        try {
            gather(pieces, manifest, options.common, job["result"]);
            if (options.removes) pieces.remove();
            say(options.common, output_of(pieces).string());
        } catch (const MissingPieces& error) {
            failure += (failure.empty() ? "" : "; ") + std::string(error.what());
            job["missing"] = error.missing;
            job["path"] = nullptr;
        } catch (const GateError& error) {
            gate = error.what();
        }
        for (const Json& name : job["missing"]) missing.push_back(name);
        jobs.push_back(job);
    }
    if (options.common.json)
        print({{"pieces", count},
               {"missing", missing},
               {"path", jobs.size() == 1 ? jobs[0]["path"] : Json(nullptr)},
               {"result", jobs.size() == 1 ? jobs[0].value("result", Json(nullptr)) : Json(nullptr)},
               {"jobs", jobs}});
    if (!failure.empty()) fail(failure);
    if (gate) throw GateError(*gate);
}

}  // namespace

void add_gather(CLI::App& program)
{
    auto options = std::make_shared<GatherCommandOptions>();
    CLI::App* command = program.add_subcommand("gather", "Joins the pieces that tasks of a command have made");
    command
        ->add_option(
            "MANIFEST", options->manifests,
            "OUTPUT, OUTPUT.pieces, or manifest.json in it, of one job or several: the command that its tasks ran "
            "makes its output from their pieces, equal to that of one process bit for bit")
        ->required();
    command->add_flag("--remove", options->removes, "Delete the pieces once they are joined");
    command->add_option("--threads", options->common.threads, "Worker threads; 0: one per core")
        ->check(CLI::Range(0, 1024));
    add_output_options(*command, options->common);
    command->footer(
        "If pieces are missing, they are named, nothing is written, and the exit status is 1. Tasks that make them:\n"
        "  for i in 0 1 2 3; do shvr label scan/ --threshold 120 -o parts.zarr --task $i/4; done\n\n"
        "Example:\n  shvr gather parts.zarr.pieces");
    command->callback([options] { run_gather(*options); });
}

}  // namespace shvr::cli
