#pragma once
// The folder in which independent processes leave their pieces of one job, until one process joins them.
//
//   OUTPUT.pieces/manifest.json   what the job is: written by the first task, compared by all others
//   OUTPUT.pieces/piece-3         the piece of task 3, a file or a folder: renamed into place once it is complete
//
// Any task may be killed, repeated, or run twice at once: a piece that is there is complete, and equal tasks make equal
// pieces. Any thread.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/pieces/task_choice.h"

namespace shvr {

/// What all tasks of a job must agree on.
struct PieceManifest {
    std::string version;               ///< version of the program: another one may round differently
    std::vector<std::string> command;  ///< the arguments, without those that concern one process only
    std::filesystem::path folder;      ///< the working folder, to which arguments are relative
    int64_t tasks = 1;
    std::vector<std::string> inputs{};  ///< names, sizes and times of the files that are read
};

/// Fails to join: some tasks have left no piece.
class MissingPieces : public Error {
public:
    MissingPieces(const std::string& sentence, std::vector<std::string> names)
        : Error(sentence), missing(std::move(names))
    {}
    std::vector<std::string> missing;  ///< the tasks to run, as in "2/8"
};

class Pieces {
public:
    /// `output`: the path of the result. Reads and writes nothing.
    static Pieces of_output(const std::filesystem::path& output);
    /// `manifest`: OUTPUT.pieces, the file in it, or OUTPUT.
    static Pieces of_manifest(const std::filesystem::path& manifest);

    const std::filesystem::path& folder() const { return folder_; }
    std::filesystem::path manifest_path() const { return folder_ / "manifest.json"; }
    std::filesystem::path piece(int64_t task) const;
    bool has(int64_t task) const;

    /// Begins a task: writes the manifest, or fails with a sentence if the one that is there differs from it. Removes
    /// what killed tasks left.
    void begin(const PieceManifest& manifest) const;
    /// Fails with a sentence if there is none, or if it is no manifest or a damaged one.
    PieceManifest manifest() const;
    /// Removes the temporary files of killed tasks (collect_temporary_files), also in unfinished pieces. Never fails.
    void collect_temporary() const;
    /// Returns the tasks of `of` that have left no piece, as in "2/8".
    std::vector<std::string> missing(int64_t of) const;
    /// Throws MissingPieces if there are any.
    void expect_all(int64_t of) const;
    /// Deletes the manifest and the pieces.
    void remove() const;

private:
    explicit Pieces(std::filesystem::path folder) : folder_(std::move(folder)) {}
    void expect_equal(const PieceManifest& found, const PieceManifest& wanted) const;

    std::filesystem::path folder_;
};

/// Returns lines that change if a file, or a file of voxels next to a header, is replaced or written to; for a folder,
/// one of the files directly in it; for an address, the address alone.
std::vector<std::string> input_signatures(const std::filesystem::path& path);

}  // namespace shvr
