#pragma once
// Reads one DICOM file: the description of its slices, as GDCM parses it, and their pixels. GDCM keeps process-wide
// state, so calls to it are serialised; any thread may call these functions.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/formats/dicom/dicom_layout.h"
#include "engine/formats/rescaled.h"

namespace shvr {

/// One slice: a frame of a file.
struct DicomFrame {
    std::optional<glm::dvec3> position{};  ///< the centre of its first pixel, mm, LPS
    glm::dvec3 along_x{1.0, 0.0, 0.0};     ///< from column to column
    glm::dvec3 along_y{0.0, 1.0, 0.0};     ///< from row to row
    std::optional<glm::dvec2> spacing{};   ///< mm from column to column, from row to row
    bool has_orientation = false;
    /// Stated distance between slices in mm or, if missing, their thickness. Negative: slices run against the normal.
    std::optional<double> distance{};
    int64_t time_number = 0;  ///< temporal position
    std::string stack{};      ///< identifies the frame's stack of slices, for files with several stacks
    Rescale rescale{};
};

/// How its pixels are stored.
struct DicomStored {
    DicomLayout layout{};
    int bits = 0;      ///< bits per pixel, at most the number of bits of the pixel's type
    int high_bit = 0;  ///< index of the highest bit
    bool is_signed = false;
};

struct DicomFile {
    std::filesystem::path path{};
    DicomStored stored{};
    std::string series_uid{};
    std::string series_description{};  ///< UTF-8
    int64_t series_number = 0;
    std::string instance_uid{};
    int64_t instance_number = 0;
    int64_t time_number = 0;  ///< temporal position, or acquisition
    int64_t columns = 0;
    int64_t rows = 0;
    VoxelType type = VoxelType::uint16;
    bool is_inverted = false;             ///< MONOCHROME1: low values are bright
    bool spacing_is_at_detector = false;  ///< the spacing applies at the detector: it is not scaled to the object
    double tilt_degrees = 0.0;            ///< tilt of the gantry
    std::vector<DicomFrame> frames{};
};

/// Returns null if the file is not a DICOM file, or has no pixels (a DICOMDIR or a report). Fails if the file is
/// damaged, or of a kind that cannot be part of a volume.
std::optional<DicomFile> read_dicom_file(const std::filesystem::path& path);

/// Returns the pixels of one frame, x fastest, in native byte order; `bytes` is their expected size. Uncompressed
/// pixels are copied from the file. Compressed pixels are decoded by GDCM or OpenJPEG, which get no other part of the
/// file.
std::vector<std::byte> read_dicom_pixels(const DicomFile& file, size_t frame, size_t bytes);

}  // namespace shvr
