#pragma once
// An import by several processes: each imports a part of the slabs of 64 slices, and one joins the parts to the project
// that one process would make, bit for bit.
//
// A piece is a folder with the chunks that its slabs complete, at every level, and a state: ranges, hashes, counts, and
// those slices of coarser levels whose chunks need slabs of other processes. Joining links the chunk files, makes the
// remaining chunks, and writes the small files. A volume of which little is stored is imported while joining; its
// pieces are empty.

#include "engine/pieces/task_choice.h"
#include "engine/projects/import_volume.h"

namespace shvr {

/// Imports the slabs of a task to the folder `piece`, which appears once it is complete. Until then it is PIECE.part,
/// from which the same call resumes. `options.gaps` must be null. Fails as import_volume does.
void import_piece(const VolumeSource& source, const std::filesystem::path& origin, const std::filesystem::path& piece,
                  const ImportOptions& options, const TaskChoice& task);

/// Makes the project from the pieces of all tasks, which stay as they are. Fails with a sentence if a piece was made
/// from another source or with other options.
ImportReport join_import(const VolumeSource& source, const std::filesystem::path& origin,
                         const std::filesystem::path& project, const ImportOptions& options,
                         const std::vector<std::filesystem::path>& pieces);

}  // namespace shvr
