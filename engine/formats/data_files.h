#pragma once
// Finds voxels in several files, as NRRD and MetaImage reference them: by a numbered pattern, or by a list of names
// after the header. Also handles the user's choice in files that hold several volumes. Any thread may call these.

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "engine/formats/header_fields.h"
#include "engine/volume/source.h"

namespace shvr {

/// is_list() returns whether the value of a data file field is a list ("LIST" or "LIST 2"); is_pattern() returns
/// whether it is a pattern ("name%03d.raw 1 93 1", optionally with one more number at the end).
bool is_list(std::string_view data_file);
bool is_pattern(std::string_view data_file);

/// Returns the paths of the files that `field` names, in order. `rest` is the text after the field's line: the names of
/// a list, one per line. Fails unless the number of files fits `size`. By default, each file holds one slice; the
/// field's last word may state another number of axes per file: 1 (a row) or 3 (several slices).
std::vector<std::filesystem::path> data_files(const HeaderFields& fields, const char* field, std::string_view rest,
                                              const Size3& size);

/// Returns the index, from 0, of the channel or time point of `file` that the options choose out of `count`. `names`:
/// of the channels, if known. Fails, listing the choices, if there are several and none is chosen.
int64_t chosen_channel(const std::string& file, const OpenOptions& options, int64_t count,
                       std::span<const char* const> names = {});
int64_t chosen_frame(const std::string& file, const OpenOptions& options, int64_t count);

/// Returns the usual names of colour channels, in order, if `count` is 3 or 4; otherwise an empty list.
std::span<const char* const> color_names(int64_t count);

}  // namespace shvr
