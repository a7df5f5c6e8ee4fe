#pragma once
// Voxels in several files, as referenced by NRRD and MetaImage: a numbered pattern, or a list of names after the
// header. Also handles the user's choice in files that hold several volumes. Any thread may call these.

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "engine/formats/header_fields.h"
#include "engine/volume/source.h"

namespace shvr {

/// is_list(): whether the value of a data file field is a list ("LIST" or "LIST 2"). is_pattern(): whether it is a
/// pattern ("name%03d.raw 1 93 1", optionally with one more number at the end).
bool is_list(std::string_view data_file);
bool is_pattern(std::string_view data_file);

/// The files that `field` names, in order, as paths. `rest` is the text after the field's line: the names of a list,
/// one per line. Fails unless the number of files suits `size`: one file per slice; or, if the field's last word (the
/// number of axes of a file) says so, one per row, or files with equal numbers of slices.
std::vector<std::filesystem::path> data_files(const HeaderFields& fields, const char* field, std::string_view rest,
                                              const Size3& size);

/// Index, from 0, of the channel or time point in `file` that the options choose. `count`: how many the file holds.
/// `names`: names of channels, if any. Fails, listing the choices, if there are several and none is chosen.
int64_t chosen_channel(const std::string& file, const OpenOptions& options, int64_t count,
                       std::span<const char* const> names = {});
int64_t chosen_frame(const std::string& file, const OpenOptions& options, int64_t count);

/// The usual names of colour channels, in order, if `count` is 3 or 4; otherwise empty.
std::span<const char* const> color_names(int64_t count);

}  // namespace shvr
