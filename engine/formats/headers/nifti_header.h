#pragma once
// Parses the headers of NIfTI-1 and NIfTI-2, one struct of 348 or 540 bytes in either byte order
// (https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h, nifti2.h). For source_nifti.cpp. Any thread.

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

#include <glm/glm.hpp>

namespace shvr {

struct NiftiHeader {
    static constexpr size_t BYTES_OF_1 = 348;
    static constexpr size_t BYTES_OF_2 = 540;

    int version = 1;
    bool is_pair = false;          ///< the voxels are in an .img file next to the .hdr
    bool big_endian = false;       ///< applies to header and voxels
    std::array<int64_t, 8> dim{};  ///< number of dimensions, then their lengths
    int datatype = 0;
    std::array<double, 8> pixdim{};
    double voxels_at = 0.0;  ///< bytes; a float in NIfTI-1
    double slope = 0.0;
    double intercept = 0.0;
    int units = 0;
    int qform_code = 0;
    int sform_code = 0;
    glm::dvec3 quaternion{0.0};  ///< b, c, d
    glm::dvec3 qform_origin{0.0};
    glm::dmat3 sform_steps{0.0};  ///< columns: steps between voxels along x, y and z
    glm::dvec3 sform_origin{0.0};
};

/// Returns null if `head`, the first bytes of a file, is not a NIfTI header.
std::optional<NiftiHeader> parse_nifti_header(std::string_view head);

/// Whether `head` is a header of Analyze 7.5, the predecessor of NIfTI-1.
bool is_analyze_header(std::string_view head);

/// The steps between voxels and the origin, as the header's qform states them.
struct NiftiAxes {
    glm::dmat3 steps{1.0};
    glm::dvec3 origin{0.0};
};
std::optional<NiftiAxes> qform_axes(const NiftiHeader& header);
std::optional<NiftiAxes> sform_axes(const NiftiHeader& header);

}  // namespace shvr
