#pragma once
// Shared by tests that use a device: the one renderer of the process, volumes in memory, and the reference's version of
// every picture that the renderer makes.
//
//     TEST_CASE_FIXTURE(OnDevice, "a sentence about behaviour")
//     {
//         load(noise_volume({33, 33, 33}, 7));
//         const Session session = plain_session({{0.0, RED, 0.0}, {65535.0, RED, 0.1}});
//         check_below("noise", error(session, camera_along(volume(), {1, 2, 3}, 40.0)), 2e-5);
//     }
//
// One thread.

#include <functional>
#include <string>

#include "engine/picture/renderer.h"
#include "tests/reference/render.h"

namespace shvr::test {

/// A volume made by a test. Its statistics report `minimum` and `maximum`, whatever the voxels are: with uint16 and the
/// whole range, a voxel's value is its code on the device.
struct TestVolume {
    glm::ivec3 size{1};
    std::vector<double> voxels{};  ///< x fastest; within the range of `type`
    VoxelType type = VoxelType::uint16;
    glm::dvec3 spacing{1.0};
    double minimum = 0.0, maximum = 65535.0;

    VolumeInfo info() const;
    IntensityWindow window() const { return window_for(type, minimum, maximum); }
};

/// `value` is evaluated at every voxel centre, and rounded to a whole number.
TestVolume volume_of(const glm::ivec3& size, const std::function<double(const glm::dvec3& voxel)>& value);
TestVolume constant_volume(const glm::ivec3& size, double value);
/// Independent values, uniform over all codes: the roughest possible field. Equal seeds give equal values.
TestVolume noise_volume(const glm::ivec3& size, uint32_t seed);
std::unique_ptr<VolumeSource> source_of(const TestVolume& volume);
/// Trilinear between voxel centres; the border is repeated.
double value_at(const TestVolume& volume, const glm::dvec3& voxel);

inline constexpr glm::dvec3 RED{1.0, 0.25, 0.0}, GREEN{0.1, 1.0, 0.2}, BLUE{0.0, 0.5, 1.0}, WHITE{1.0};

/// Unshaded, exact sampling, no early ray termination, over opaque black: only the integral.
Session plain_session(std::vector<ControlPoint> points, const glm::uvec2& pixels = {8, 8});
/// Four tones across all codes, transparent at both ends.
std::vector<ControlPoint> busy_points(double densest = 0.2);
/// Transparent for every code.
std::vector<ControlPoint> unseen_points();
/// One colour and opacity for every code.
std::vector<ControlPoint> uniform_points(const glm::dvec3& color, double opacity);

/// Orthographic, from outside, through the volume's centre; `height` in physical units. `direction` need not be unit.
Camera camera_along(const TestVolume& volume, const glm::dvec3& direction, double height);
Camera perspective(const glm::dvec3& eye, const glm::dvec3& target, double fov_y_degrees);

/// The 26 directions to the faces, edges and corners of a cube.
std::vector<glm::dvec3> cube_directions();

double opacity_of_depth(double depth);
double depth_of_opacity(double opacity);

using Pixels = std::vector<glm::dvec4>;
Pixels pixels_of(const ImageF& image);
/// The largest difference in any channel of any pixel.
double worst_difference(const Pixels& a, const Pixels& b);
double rms_difference(const Pixels& a, const Pixels& b);
/// Counts values (not pixels) whose bits differ.
size_t different_bits(const ImageF& a, const ImageF& b);

/// Prints the error if the check fails, and with --success.
void check_below(const std::string& what, double error, double bound);

/// Fixture: the process's renderer, with one volume in it. Fails the test case if the validation layer reports
/// anything.
class OnDevice {
public:
    OnDevice();
    ~OnDevice();

    Renderer& renderer() { return renderer_; }
    const TestVolume& volume() const { return volume_; }

    void load(TestVolume volume, Sampling sampling = Sampling::exact);
    /// Checks that every value is finite.
    ImageF draw(const Session& session, const Camera& camera);
    /// Sums over the whole picture, by the numbers of shaders/counters.h.
    std::vector<uint64_t> work(const Session& session, const Camera& camera);

    /// The reference's picture over the background, premultiplied, from the same codes along the same rays.
    Pixels expected(const Session& session, const Camera& camera, const reference::Mode& mode) const;
    /// The same samples that the device takes, in double.
    Pixels discrete(const Session& session, const Camera& camera) const;
    /// The difference between the device and `discrete`: rounding.
    double error(const Session& session, const Camera& camera);

private:
    Renderer& renderer_;
    TestVolume volume_;
};

/// The scene that the reference draws for a session: densities are codes / 65535, and the transfer function is
/// converted from intensities to those.
reference::Scene scene_of(const TestVolume& volume, const Session& session, const Camera& camera);
/// The discrete model with a table as fine as the device's.
reference::DiscreteOptions tabulated(const TestVolume& volume, const Session& session);
std::vector<reference::Ray> rays_of(const TestVolume& volume, const Session& session, const Camera& camera);

}  // namespace shvr::test
