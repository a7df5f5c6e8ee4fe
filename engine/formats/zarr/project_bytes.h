#pragma once
// Files of a project (project.h) that do not come from a folder. `file` names them in messages. Any thread.

#include <span>

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/formats/zarr/project.h"

namespace shvr {

/// A newer version of SHVR wrote the record. A damaged record is ignored, but not this one: the other files of the
/// project may have newer forms, too, and a save would damage them.
class NewerProject : public Error {
public:
    using Error::Error;
};

/// As read_project_record.
ProjectRecord project_record_of(const JsonDocument& document);
/// As read_project_table.
ProjectTable project_table_of(std::span<const std::byte> bytes, const std::filesystem::path& file,
                              const ProjectTable& expected);
/// The largest size of a table's file.
int64_t most_table_bytes();

}  // namespace shvr
