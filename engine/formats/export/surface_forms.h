#pragma once
// The formats of surface_export.h, a writer for each. Any thread.

#include <cstring>
#include <span>

#include "engine/base/atomic_writer.h"
#include "engine/formats/export/surface_export.h"

namespace shvr {

/// Appends values to a file in pieces of a megabyte.
class SurfaceWriter {
public:
    /// Fails if the disk has less free space than `bytes`.
    SurfaceWriter(const std::filesystem::path& path, uint64_t bytes);
    void text(std::string_view text)
    {
        bytes_ += text;
        flush(FLUSH_BYTES);
    }
    /// In little-endian order.
    template <class... Values>
    void values(const Values&... values)
    {
        (add(values), ...);
        flush(FLUSH_BYTES);
    }
    void commit();

private:
    static constexpr size_t FLUSH_BYTES = size_t{1} << 20;
    template <class Value>
    void add(const Value& value)
    {
        char raw[sizeof value];
        std::memcpy(raw, &value, sizeof value);
        bytes_.append(raw, sizeof value);
    }
    void flush(size_t above);

    AtomicWriter writer_;
    std::string bytes_;
};

/// The progress of one of several equal steps of each part.
class PartProgress {
public:
    PartProgress(const Progress& progress, size_t steps) : progress_(progress), steps_(double(steps)) {}
    Progress next()
    {
        const double step = step_++;
        return part_of(progress_, step / steps_, (step + 1.0) / steps_);
    }

private:
    const Progress& progress_;
    double steps_, step_ = 0.0;
};

void export_stl(const std::filesystem::path& path, SurfaceParts& surfaces, const Progress& progress);
void export_ply(const std::filesystem::path& path, SurfaceParts& surfaces, const Progress& progress);
void export_obj(const std::filesystem::path& path, SurfaceParts& surfaces, const Progress& progress);
void export_glb(const std::filesystem::path& path, SurfaceParts& surfaces, const Progress& progress);

}  // namespace shvr
