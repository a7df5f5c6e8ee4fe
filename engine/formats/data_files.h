#pragma once
// Voxels in several files, as NRRD and MetaImage name them: a pattern with numbers, or a list of names behind the
// header. And what a person chooses where a file holds several volumes. Any thread may call these.

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "engine/formats/header_fields.h"
#include "engine/volume/source.h"

namespace shvr {

/// Whether the value of a data file field is "LIST" or "LIST 2", or "name%03d.raw 1 93 1" or with a number behind.
bool is_list(std::string_view data_file);
bool is_pattern(std::string_view data_file);

/// The files that `field` names, in order, as paths. `rest` is what follows the field's line: the names of a list, one
/// a line. Fails where their number is not one that voxels of `size` can be spread over equally: as many as slices; or
/// as many as rows, or such that each holds a number of slices, where the number of axes of a file, the field's last
/// word, says so.
std::vector<std::filesystem::path> data_files(const HeaderFields& fields, const char* field, std::string_view rest,
                                              const Size3& size);

/// The channel or point in time, from 0, that the options choose in `file`, which holds `count` of them; `names` are
/// those of channels, if they have any. Fails, naming the choices, where there are several and none of them is chosen.
int64_t chosen_channel(const std::string& file, const OpenOptions& options, int64_t count,
                       std::span<const char* const> names = {});
int64_t chosen_frame(const std::string& file, const OpenOptions& options, int64_t count);

/// As channels are called that are colours, by their number: names for 3 and 4, none for others.
std::span<const char* const> color_names(int64_t count);

}  // namespace shvr
