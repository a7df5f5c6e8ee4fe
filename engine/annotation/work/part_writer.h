#pragma once
// Writes one part of a document to its file. Any thread may call it.

#include <string>
#include <vector>

#include "engine/annotation/work/journal.h"
#include "engine/annotation/work/saved_files.h"
#include "engine/projects/import_sparse.h"

namespace shvr {

/// `journal`: its name (from `files`) and its last durable record are recorded with the mask; null if there is none.
/// Returns a sentence if the old image is kept under another name because `foreign` demands it. If `progress` throws,
/// the file (or image) stays as it was.
std::string write_part(Part part, const Document& document, const WorkFiles& files,
                       const std::vector<LabelImage::Color>& looks, const Journal* journal, Foreign foreign,
                       const Progress& progress = {});

}  // namespace shvr
