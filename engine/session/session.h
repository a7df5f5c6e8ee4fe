#pragma once
// A session: everything that determines a picture, in one JSON file (version 1). The window, the command line, goldens
// and bug reports all use it. engine/session/README.md lists every key; unknown keys are refused by name.

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "engine/annotation/brush.h"
#include "engine/formats/open_volume.h"
#include "engine/look/camera.h"
#include "engine/look/groups.h"
#include "engine/look/look.h"
#include "engine/look/panes.h"
#include "engine/look/settings.h"
#include "engine/look/surface_tree.h"
#include "engine/look/transfer_function.h"
#include "engine/volume/source_procedural.h"

namespace shvr {

/// What turning the view goes about: the middle of what is looked at, the probe, or a point that was picked.
enum class Pivot { target, probe, picked };
inline constexpr Spelling<Pivot> PIVOTS[] = {
    {Pivot::target, "target"}, {Pivot::probe, "probe"}, {Pivot::picked, "picked"}};
constexpr std::span<const Spelling<Pivot>> spellings_of(Pivot)
{
    return PIVOTS;
}

/// Settings of the interactive window.
struct InteractionSettings {
    double resolution = 0.7;  ///< share of the screen's, along each axis, while something moves; less if that is slow
    double frames_per_second = 30.0;  ///< at most
    uint32_t screenshot_scale = 4;    ///< of large screenshots: pixels for one of the window, along each axis
    double workspace_scale = 1.0;     ///< how far the probe goes for a move of a haptic device's hand
    Pivot pivot = Pivot::target;
    // Lines and words that the window draws over its pictures
    bool scale_bar = true;
    bool axes = true;
    bool probe_label = true;        ///< the probe's depth, and how much of it is relevant
    bool group_legend = true;       ///< colours and names of the groups that are drawn
    bool screenshot_marks = false;  ///< screenshots have scale bar, axes, groups and distances as the window shows them
    bool operator==(const InteractionSettings&) const = default;
};

inline constexpr double MIN_WORKSPACE_SCALE = 0.01, MAX_WORKSPACE_SCALE = 100.0;

/// What the left mouse button does in the window, where Alt is not held:
///
///   turn      turns the volume
///   paint     paints with the active group while held
///   erase     takes paint away while held, whatever the active group is
///   trace     a click beside all nodes adds one, linked with the selected one; on a node it selects, a drag moves it
///   select    selects the node or internode that is clicked
///   measure   a click is one end of a distance, the next one the other
///
/// F, the stylus, and in the turn tool the right button, paint; they erase in the erase tool, and add a node in the
/// trace tool. Alt + left turns everywhere, and so do the middle and the right button outside the turn tool; Shift +
/// left and Shift + middle move, as the middle button does in the turn tool.
enum class Tool { turn, paint, erase, trace, select, measure };
inline constexpr Spelling<Tool> TOOLS[] = {{Tool::turn, "turn"},     {Tool::paint, "paint"},
                                           {Tool::erase, "erase"},   {Tool::trace, "trace"},
                                           {Tool::select, "select"}, {Tool::measure, "measure"}};
constexpr std::span<const Spelling<Tool>> spellings_of(Tool)
{
    return TOOLS;
}

/// How the probe is pulled to what is relevant: haptics/proxy.h.
enum class Guidance { potential, mean, thesis };
inline constexpr Spelling<Guidance> GUIDANCES[] = {
    {Guidance::potential, "potential"}, {Guidance::mean, "mean"}, {Guidance::thesis, "thesis"}};
constexpr std::span<const Spelling<Guidance>> spellings_of(Guidance)
{
    return GUIDANCES;
}

/// What of it pulls the probe: haptics/settings.h.
enum class TouchMode { proximity, surface, object };
inline constexpr Spelling<TouchMode> TOUCH_MODES[] = {
    {TouchMode::proximity, "proximity"}, {TouchMode::surface, "surface"}, {TouchMode::object, "object"}};
constexpr std::span<const Spelling<TouchMode>> spellings_of(TouchMode)
{
    return TOUCH_MODES;
}

/// The plane of voxels that the probe stays in, by the axis across it.
enum class TouchPlane { none, x, y, z };
inline constexpr Spelling<TouchPlane> TOUCH_PLANES[] = {
    {TouchPlane::none, "none"}, {TouchPlane::x, "x"}, {TouchPlane::y, "y"}, {TouchPlane::z, "z"}};
constexpr std::span<const Spelling<TouchPlane>> spellings_of(TouchPlane)
{
    return TOUCH_PLANES;
}

/// How a hand feels the volume and is helped, with whatever device.
struct FeelSettings {
    TouchMode mode = TouchMode::proximity;
    double strength = 1.0;        ///< share of the force
    double surface_share = 0.4;   ///< of the probe's ball: above it a surface holds
    double stiffness = 300.0;     ///< N/m of a probe of 2.5 mm in the hand
    double damping = 1.0;         ///< N s/m
    std::vector<uint8_t> groups;  ///< those that are felt, ascending, 0: what no group holds; empty: everything
    bool at_proxy = false;        ///< tools act at the middle of what is touched
    bool overlap_radius = false;  ///< new nodes are as wide as the ball's filling tells
    bool to_nodes = false;        ///< tools act at a node that lies in the ball
    bool to_lines = false;        ///< tools act at the nearest point of a centre line that passes through the ball
    bool clicks = false;          ///< a short push of the device where contact begins
    TouchPlane plane = TouchPlane::none;
    bool operator==(const FeelSettings&) const = default;
};
inline constexpr double MAX_STIFFNESS = 1000.0, MAX_FELT_DAMPING = 1.2;

/// The probe and the brush. Values not given here are chosen for the volume.
struct ProbeSettings {
    std::optional<glm::dvec3> voxel;  ///< the probe's centre; default: the volume's middle
    BrushSettings brush;
    std::optional<double> haptic_threshold;  ///< intensity; default: the brush's threshold
    bool shown = false;                      ///< in pictures; the window shows it always
    /// An iso-surface at the brush's threshold in the probe's region: it shows what density painting would raise above
    /// it.
    bool shell = false;
    double shell_opacity = 0.4;  ///< of one crossing
    bool preview = false;        ///< the brush's effect at the probe is drawn
    Tool tool = Tool::turn;
    bool guided = false;
    Guidance guidance = Guidance::potential;
    FeelSettings touch;
    std::optional<glm::dvec3> color;           ///< linear light; default: its group's
    double opacity = 1.0;                      ///< of its ball
    bool silhouette = true;                    ///< its outline over whatever hides it
    bool arrow = true;                         ///< towards it, where it is out of sight
    std::optional<double> node_radius_voxels;  ///< of new nodes, along x; default: for the volume
    bool measured_radius = false;              ///< new nodes are as wide as what they lie in, where that can be told
    bool centered_nodes = true;                ///< clicked nodes go into the middle of what is seen, not onto its wall
    /// What painting gives voxels to: the active group, or 0.
    uint8_t painted_group() const { return tool == Tool::erase ? uint8_t(0) : brush.group; }
    bool operator==(const ProbeSettings&) const = default;
};

/// Of one file.
inline constexpr size_t MAX_SESSION_SURFACES = 100'000;

/// A distance between two points that a person measured, in voxels: it follows a spacing that is corrected.
struct Measurement {
    glm::dvec3 from{0.0}, to{0.0};
    bool operator==(const Measurement&) const = default;
};
/// Each step of the history holds all of them, before and after.
inline constexpr size_t MAX_MEASUREMENTS = 1000;

struct Session {
    std::filesystem::path volume_path;  ///< absolute, or empty where `procedural` is set
    std::optional<ProceduralSpec> procedural;
    std::optional<RawLayout> raw_layout;  ///< for bare voxels
    OpenOptions open_options;             ///< selects from files that hold more than one volume
    /// Of the volume's voxels (content_hash.h), computed by `open_session`; empty if it did not visit all voxels, and
    /// in a session that was only read. Not written.
    std::string volume_hash;
    std::map<std::string, CameraSpec> cameras;  ///< by name; may be empty
    std::string camera_name;                    ///< the one to use, as `camera_named` takes it; may be empty
    TransferFunction transfer_function;
    std::string transfer_preset;  ///< `open_session` turns it into a function and clears it
    Groups groups;
    Unpainted unpainted;
    Light light;
    DistanceBlend blend;
    RenderSettings render;
    ViewSettings view;
    InteractionSettings interaction;
    CutBox cut;
    std::vector<Measurement> measurements;  ///< at most MAX_MEASUREMENTS
    ProbeSettings probe;
    std::vector<SurfaceLook> surfaces;  ///< opaque balls and rods; at most MAX_SESSION_SURFACES in a file
    std::filesystem::path mask_path;    ///< absolute; empty: none; the file need not exist yet
    /// Likewise for the trace, in a form that `load_trace` reads; default: beside the mask.
    std::filesystem::path trace_path;
    std::filesystem::path density_path;  ///< likewise, for density offsets
    /// The journal beside the session's file (engine/annotation/work/work.h); empty if a bare volume was opened.
    std::filesystem::path journal_path;
    bool operator==(const Session&) const = default;

    /// The part that pictures depend on.
    Look look() const;
};

/// `path`: a session file (.json), a project folder (its shvr/session.json), or a volume file (a session is made for
/// it: its path, and a transfer function from its statistics, which `warnings` reports).
/// `settings`: "key=value" with dotted keys ("render.step_voxels=0.25"), applied to the JSON before it is read.
/// Relative paths in the file are relative to the file. A session file without a transfer function gets the same
/// automatic one as a volume file. Session files hold at most 16 MiB. A picture that this program made holds the
/// session it was made of (picture_session.h).
struct OpenedSession {
    Session session;
    std::shared_ptr<const VolumeSource> source;
    VolumeStatistics statistics;
    std::vector<std::string> warnings;  ///< of the session; those of the volume are in `source->info().warnings`
    std::vector<std::string> losses;    ///< what is not there although it was saved
    std::filesystem::path pictured{};   ///< of a picture: the session or project it was made of; empty: no picture
};
struct OpeningOptions {
    MeasureOptions measure{};
    /// Called before any voxel is read, to refuse what is too large.
    std::function<void(const Session& session, const VolumeSource& source)> before_reading{};
};
OpenedSession open_session(const std::filesystem::path& path, const std::vector<std::string>& settings = {},
                           const OpeningOptions& options = {});
/// Skips everything that needs a pass over the voxels: the transfer function is the file's, and only projects have a
/// hash.
struct UnmeasuredSession {
    Session session;
    std::shared_ptr<const VolumeSource> source;
    std::vector<std::string> losses;  ///< as in OpenedSession
    std::filesystem::path pictured{};
};
UnmeasuredSession open_unmeasured_session(const std::filesystem::path& path,
                                          const std::vector<std::string>& settings = {});

/// The session file that `path` stands for: itself, or a project's, which may be missing; empty for a volume. Fails if
/// there is nothing at `path`.
std::filesystem::path session_file_of(const std::filesystem::path& path);
/// "scan.journal" for "scan.json".
std::filesystem::path journal_beside(const std::filesystem::path& session_file);

/// The same from text; relative paths are relative to `folder`, `origin` names the text in messages.
Session parse_session(const std::string& text, const std::filesystem::path& folder, const std::string& origin,
                      const std::vector<std::string>& settings = {});
std::unique_ptr<VolumeSource> open_source(const Session& session);

/// The upper end of the darker of two classes of voxels, the air around a scanned object (Otsu's threshold, but never
/// less than half of all voxels), and the value that nine tenths of the rest lie below.
struct TissueRange {
    double lower = 0.0, upper = 1.0;  ///< intensities, lower < upper
};
TissueRange tissue_range(const VolumeStatistics& statistics);

/// A ramp from grey to warm that leaves the darker of two classes of voxels out (Otsu's threshold, but never less than
/// half of all voxels), so that the air around a scanned object is invisible. Equal statistics give equal functions.
TransferFunction automatic_transfer_function(const VolumeStatistics& statistics);

/// Halfway between a transfer function's lowest point and its mean intensity, weighted by opacity, within the volume's
/// range: the brush's default threshold.
double automatic_threshold(const TransferFunction& function, const VolumeStatistics& statistics);

/// The radius of new nodes where nobody chose one, in voxels along x: 1/500 of the volume's diagonal, at least a voxel.
double automatic_node_radius(const VolumeInfo& info);

/// Intensities that slices draw black and white where nobody chose them: all but the darkest 0.5 % and the brightest
/// 0.35 % of the voxels lie between them, to a bin of the histogram. The whole range where there is no histogram.
ValueRange automatic_contrast(const VolumeStatistics& statistics);

/// The camera of that name: a named one of the session, a side of `camera_looking`, or a JSON object. Empty: the one
/// that the session names "front", or else that looks at the side_of_largest_face.
Camera camera_named(const Session& session, const std::string& name_or_json, const VolumeInfo& volume);

/// The names that `camera_named` takes: cameras of the session, then sides.
std::vector<std::string> camera_names(const Session& session);

/// Writes every key in the form that `parse_session` reads. Paths inside `folder` (if that is a project's shvr: inside
/// the project) are relative to it, others absolute. Colours are rounded to the 8 bits of their spelling.
std::string to_text(const Session& session, const std::filesystem::path& folder);

}  // namespace shvr
