#pragma once
// For commands that can be split into independent tasks: `--task I/N`, `--task slurm`, and `shvr gather`, which runs
// the command that the manifest names again, with `--task gather`.
//
//   const SplitJob job(options.task, options.output);
//   job.begin(inputs of this run);                     // writes or compares the manifest
//   if (job.is_task() && job.is_done()) return job.report();
//   if (job.is_task()) { write job.piece(), the part job.choice().range_of(count); return job.report(); }
//   if (job.gathers()) { read job.piece(i) for each i below job.of(), and write the output; }

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "engine/pieces/pieces.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

/// Keeps the arguments of this process, for manifests. Call before they are parsed.
void note_arguments(const std::vector<std::string>& arguments);
/// Adds --task.
void add_task_option(CLI::App& command, std::string& task);

/// One thread.
class SplitJob {
public:
    /// `task`: the option's value; empty: the command does everything itself, whatever the environment says. `output`:
    /// the path of the result, next to which the pieces are.
    SplitJob(const std::string& task, const std::filesystem::path& output, const Common& common);

    bool is_task() const { return mode_ == Mode::task; }
    bool gathers() const { return mode_ == Mode::gather; }
    bool is_split() const { return mode_ != Mode::whole; }
    const TaskChoice& choice() const { return choice_; }
    int64_t of() const { return choice_.of; }

    /// Does nothing if the command is not split. A task: writes the manifest, or compares it with what the first task
    /// wrote; `inputs`: the files and folders that the command reads. Gathering: throws MissingPieces unless all pieces
    /// are there; compares `inputs`, unless it is empty.
    void begin(const std::vector<std::filesystem::path>& inputs);
    /// Whether this task's piece exists.
    bool is_done() const { return pieces_.has(choice_.index); }
    std::filesystem::path piece() const { return pieces_.piece(choice_.index); }
    std::filesystem::path piece(int64_t task) const { return pieces_.piece(task); }
    std::vector<std::filesystem::path> all_pieces() const;
    const std::filesystem::path& folder() const { return pieces_.folder(); }

    /// Prints where this task's piece is, and which pieces are still missing.
    void report() const;

private:
    enum class Mode { whole, task, gather };

    const Common& common_;
    Mode mode_ = Mode::whole;
    TaskChoice choice_;
    Pieces pieces_;
};

/// The files of a session, besides the file or folder `path` that was opened.
std::vector<std::filesystem::path> inputs_of(const std::filesystem::path& path, const Session& session);

/// Runs a command with --task gather in this process. Fails unless its output is the one next to `pieces`: a manifest
/// may come from elsewhere, and is obeyed only where its tasks ran. `take`: receives what the command would print.
void run_command(const std::vector<std::string>& arguments, const std::filesystem::path& pieces,
                 const std::function<void(const Json&)>& take);
/// Parses arguments and runs their command. Defined in main.cpp.
void parse_and_run(const std::vector<std::string>& arguments);

}  // namespace shvr::cli
