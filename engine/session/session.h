#pragma once
// A session: everything that determines a picture, in one JSON file (version 1). The window, the command line, goldens
// and bug reports use it. engine/session/README.md lists all keys. Unknown keys are refused by name.

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "engine/annotation/brush.h"
#include "engine/annotation/measures/measurement.h"
#include "engine/formats/open_volume.h"
#include "engine/look/camera.h"
#include "engine/look/groups.h"
#include "engine/look/look.h"
#include "engine/look/panes.h"
#include "engine/look/settings.h"
#include "engine/look/surfaces/surface_tree.h"
#include "engine/look/transfer_function.h"
#include "engine/touch/touch_mode.h"
#include "engine/volume/procedural/source_procedural.h"

namespace shvr {

/// The pivot of rotations of the view: the camera's target, the probe, or a picked point.
enum class Pivot { target, probe, picked };
inline constexpr Spelling<Pivot> PIVOTS[] = {
    {Pivot::target, "target"}, {Pivot::probe, "probe"}, {Pivot::picked, "picked"}};
constexpr std::span<const Spelling<Pivot>> spellings_of(Pivot)
{
    return PIVOTS;
}

/// Settings of the interactive window.
struct InteractionSettings {
    double resolution = 0.7;          ///< resolution in motion, relative to the screen, per axis; lower if too slow
    double frames_per_second = 30.0;  ///< upper limit
    uint32_t screenshot_scale = 4;    ///< scale of large screenshots: pixels per pixel of the window, per axis
    double workspace_scale = 1.0;     ///< motion of the probe relative to motion of the hand, with a haptic device
    Pivot pivot = Pivot::target;
    // Lines and text that the window draws over its pictures.
    bool scale_bar = true;
    bool axes = true;
    bool probe_label = true;        ///< shows the probe's depth, and the relevant fraction of its ball
    bool group_legend = true;       ///< lists the colours and names of all groups that are drawn
    bool screenshot_marks = false;  ///< whether screenshots show scale bar, axes, groups and distances, too
    bool operator==(const InteractionSettings&) const = default;
};

inline constexpr double MIN_WORKSPACE_SCALE = 0.01, MAX_WORKSPACE_SCALE = 100.0;

/// Tools of the left mouse button in the window, unless Alt is held:
///
///   turn      rotates the view
///   paint     paints with the active group while held
///   erase     removes paint of any group while held
///   trace     a click away from all nodes adds a node, linked to the selected node; on a node, it selects or drags it
///   select    selects the node or internode that is clicked
///   measure   clicks set the points of a distance, a path or an angle
///
/// F and the stylus paint; they erase with the erase tool, and add a node with the trace tool. With the turn tool the
/// right button zooms and the middle one pans. Alt + left rotates with every tool, and so do the middle and the right
/// button with all tools except turn. Shift + left and Shift + middle pan.
enum class Tool { turn, paint, erase, trace, select, measure };
inline constexpr Spelling<Tool> TOOLS[] = {{Tool::turn, "turn"},     {Tool::paint, "paint"},
                                           {Tool::erase, "erase"},   {Tool::trace, "trace"},
                                           {Tool::select, "select"}, {Tool::measure, "measure"}};
constexpr std::span<const Spelling<Tool>> spellings_of(Tool)
{
    return TOOLS;
}

/// Confines the probe to a plane of voxels, named by its normal axis.
enum class TouchPlane { none, x, y, z };
inline constexpr Spelling<TouchPlane> TOUCH_PLANES[] = {
    {TouchPlane::none, "none"}, {TouchPlane::x, "x"}, {TouchPlane::y, "y"}, {TouchPlane::z, "z"}};
constexpr std::span<const Spelling<TouchPlane>> spellings_of(TouchPlane)
{
    return TOUCH_PLANES;
}

/// Touch and assistance settings, for any device.
struct FeelSettings {
    TouchMode mode = TouchMode::proximity;
    double strength = 1.0;        ///< factor of the force
    double surface_share = 0.4;   ///< fraction of the ball that must be relevant for a surface to hold the probe
    double stiffness = 300.0;     ///< N/m, for a probe whose radius is 2.5 mm at the hand
    double damping = 1.0;         ///< N s/m
    std::vector<uint8_t> groups;  ///< groups that can be felt, ascending; 0: unpainted voxels; empty: everything
    bool at_proxy = false;        ///< tools act at the centre of the structure that the probe touches
    bool overlap_radius = false;  ///< derives the radius of a new node from the filled fraction of the probe's ball
    bool to_nodes = false;        ///< tools act at a node if the probe's ball contains one
    bool to_lines = false;        ///< tools act at the nearest point of a centre line that the probe's ball contains
    bool clicks = false;          ///< the device gives a short pulse when contact begins
    TouchPlane plane = TouchPlane::none;
    /// Lets the user feel structures that pictures do not show: cut away, transparent, or in hidden groups.
    bool feels_hidden = false;
    bool operator==(const FeelSettings&) const = default;
};
inline constexpr double MAX_STIFFNESS = 1000.0, MAX_FELT_DAMPING = 1.2;

/// Settings of the probe and the brush. Values that are not set are chosen for the volume.
struct ProbeSettings {
    std::optional<glm::dvec3> voxel;  ///< the probe's centre; default: the volume's centre
    BrushSettings brush;
    std::optional<double> haptic_threshold;  ///< intensity; default: the brush's threshold
    bool shown = false;                      ///< whether pictures show it; the window always does
    /// Shows an iso-surface at the brush's threshold in the probe's region: the limit of the voxels that density
    /// painting would raise above the threshold.
    bool shell = false;
    double shell_opacity = 0.4;  ///< opacity of each crossing of a ray with this surface
    /// Draws the brush's effect at the probe. Default: the window does while a tool that paints is in hand.
    std::optional<bool> preview;
    Tool tool = Tool::turn;
    MeasureKind measure = MeasureKind::distance;  ///< what the tool that measures begins
    bool guided = false;
    ProxyLaw guidance = ProxyLaw::potential;
    FeelSettings touch;
    std::optional<glm::dvec3> color;           ///< linear light; default: the colour of its group
    double opacity = 1.0;                      ///< opacity of the probe's ball
    bool silhouette = true;                    ///< outlines the probe over objects that hide it
    bool arrow = true;                         ///< draws an arrow to the probe when it is out of sight
    std::optional<double> node_radius_voxels;  ///< radius of new nodes along x; default: chosen for the volume
    bool measured_radius = false;              ///< new nodes get the measured radius of the structure around them, if
                                               ///< measuring succeeds
    bool centered_nodes = true;                ///< places clicked nodes at the centre of the visible structure, not on
                                               ///< its wall
    /// Returns whether the window draws the brush's effect.
    bool previews() const
    {
        return tool != Tool::trace && preview.value_or(tool == Tool::paint || tool == Tool::erase);
    }
    /// Returns the group that painting assigns to voxels: the active group, or 0 to erase.
    uint8_t painted_group() const { return tool == Tool::erase ? uint8_t(0) : brush.group; }
    bool operator==(const ProbeSettings&) const = default;
};

/// Maximum number of surfaces in one session file.
inline constexpr size_t MAX_SESSION_SURFACES = 100'000;

/// Maximum number of meshes in a session.
inline constexpr size_t MAX_SESSION_MESHES = 64;

/// A mesh of a file, to be shown with the volume (engine/session/meshes).
struct MeshLook {
    std::string file;                 ///< path, absolute or relative to the session's folder (session_folder)
    std::optional<glm::dvec3> color;  ///< linear light; default: the file's colours
    bool shown = true;
    bool operator==(const MeshLook&) const = default;
};

/// What movies mix between two views besides their cameras (engine/movie/look_between.h). A view may be kept with it.
struct KeyLook {
    TransferFunction transfer_function;
    Groups groups;
    Unpainted unpainted;
    Light light;
    DistanceBlend blend;
    CutBox cut;
    bool operator==(const KeyLook&) const = default;
};

struct Session {
    std::filesystem::path volume_path;  ///< absolute, or empty if `procedural` is set
    std::optional<ProceduralSpec> procedural;
    std::optional<RawLayout> raw_layout;  ///< layout of a raw file, which has no header
    OpenOptions open_options;             ///< what to open in files that hold several volumes
    /// Hash of the volume's voxels (content_hash.h), set by `open_session`. Empty if `open_session` did not read all
    /// voxels, or if the session was not opened by it. Not written to files.
    std::string volume_hash;
    std::map<std::string, CameraSpec> cameras;  ///< by name; may be empty
    std::string camera_name;                    ///< name of the current camera, or JSON (camera_named); may be empty
    std::map<std::string, KeyLook> key_looks;   ///< by the name of a view; may be empty (looks/key_look.h)
    TransferFunction transfer_function;
    std::string transfer_preset;  ///< preset name; `open_session` converts it into a function and clears it
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
    std::filesystem::path mask_path;    ///< absolute path of the mask, which need not exist yet; empty: none
    /// Path of the trace, in a format that `load_trace` reads; default: next to the mask. The file need not exist yet.
    std::filesystem::path trace_path;
    std::filesystem::path density_path;  ///< path of the density offsets, likewise
    /// The journal next to the session file (engine/annotation/work/work.h). Empty if a bare volume was opened.
    std::filesystem::path journal_path;
    std::vector<MeshLook> meshes;  ///< at most MAX_SESSION_MESHES
    bool operator==(const Session&) const = default;

    /// Returns the part of the session that determines pictures.
    Look look() const;
    /// Returns the groups as pictures show them. With `view.solo`, all other groups are hidden.
    Groups shown_groups() const;
};

/// open_session() opens `path`: a session file (.json), a project folder (whose shvr/session.json is
/// opened), a picture made by this program (picture_session.h) or a volume file. A volume file, and a
/// session without a transfer function, gets one from the volume's statistics, which `warnings` mention.
/// `settings`: "key=value" with dotted keys ("render.step_voxels=0.25"), applied to the JSON before it
/// is read. Relative paths in a session file are relative to the file. Session files have at most 16
/// MiB.
struct OpenedSession {
    Session session;
    std::shared_ptr<const VolumeSource> source;
    VolumeStatistics statistics;
    std::vector<std::string> warnings;   ///< about the session; `source->info().warnings` are about the volume
    std::vector<std::string> losses;     ///< saved data that is missing
    std::filesystem::path pictured{};    ///< for a picture: the session or project from which it was made; otherwise
                                         ///< empty
    std::vector<std::string> removed{};  ///< settings of earlier versions that are ignored (removed_keys_in)
};
struct OpeningOptions {
    MeasureOptions measure{};
    /// Called before any voxel is read, to be able to refuse volumes that are too large.
    std::function<void(const Session& session, const VolumeSource& source)> before_reading{};
};
OpenedSession open_session(const std::filesystem::path& path, const std::vector<std::string>& settings = {},
                           const OpeningOptions& options = {});
/// A session opened without reading voxels: it has only the transfer function of its file, and a hash only for
/// projects.
struct UnmeasuredSession {
    Session session;
    std::shared_ptr<const VolumeSource> source;
    std::vector<std::string> losses;  ///< as in OpenedSession
    std::filesystem::path pictured{};
    std::vector<std::string> removed{};  ///< as in OpenedSession
};
UnmeasuredSession open_unmeasured_session(const std::filesystem::path& path,
                                          const std::vector<std::string>& settings = {});

/// The folder of the session's file; for a volume without a session, that of the volume. Absolute.
std::filesystem::path session_folder(const Session& session);
std::filesystem::path mesh_path(const Session& session, const MeshLook& mesh);
/// Returns how a session names a mesh's file: relative if it is in its folder or project, else absolute.
std::string mesh_file_name(const Session& session, const std::filesystem::path& path);

/// Returns the session file to open for `path`: `path` itself, or the session file of a project, which may be missing;
/// empty for a volume. Fails if nothing exists at `path`.
std::filesystem::path session_file_of(const std::filesystem::path& path);
/// Returns "scan.journal" for "scan.json".
std::filesystem::path journal_beside(const std::filesystem::path& session_file);

/// Reads a session from text. Relative paths are relative to `folder`; messages call the text `origin`.
Session parse_session(const std::string& text, const std::filesystem::path& folder, const std::string& origin,
                      const std::vector<std::string>& settings = {});
std::unique_ptr<VolumeSource> open_source(const Session& session);

/// Limits of the intensities of the scanned object. Voxels are split into two classes by Otsu's threshold. `lower`:
/// that threshold, but at least the median of all voxels. `upper`: the 90th percentile of the voxels above `lower`.
struct TissueRange {
    double lower = 0.0, upper = 1.0;  ///< intensities, lower < upper
};
TissueRange tissue_range(const VolumeStatistics& statistics);

/// Returns a ramp from grey to warm colours that leaves out the darker class of voxels, at least half of all
/// (tissue_range), so that air around a scanned object is invisible. Equal statistics give equal functions.
TransferFunction automatic_transfer_function(const VolumeStatistics& statistics);

/// Returns the brush's default threshold: half-way between the lowest point of the transfer function and its mean
/// intensity, weighted by opacity; clamped to the volume's range.
double automatic_threshold(const TransferFunction& function, const VolumeStatistics& statistics);

/// Returns the default radius of new nodes, in voxels along x: 1/500 of the volume's diagonal, at least a voxel.
double automatic_node_radius(const VolumeInfo& info);

/// Returns the default intensities for black and white in slices: all but the darkest 0.5 % and the brightest 0.35 % of
/// the voxels lie between them, as exactly as histogram bins allow. Without a histogram: the whole range.
ValueRange automatic_contrast(const VolumeStatistics& statistics);

/// Returns the camera of that name: a camera of the session, a side of `camera_looking`, or a JSON object. If the name
/// is empty: the session's camera "front" or, if there is none, a camera that looks at the side_of_largest_face.
Camera camera_named(const Session& session, const std::string& name_or_json, const VolumeInfo& volume);

/// Returns the names that `camera_named` accepts: cameras of the session, then sides.
std::vector<std::string> camera_names(const Session& session);

/// Writes all keys in the form that `parse_session` reads. Paths inside `folder` (or inside the project, if `folder` is
/// a project's shvr) become relative to it, others absolute. Colours are rounded to 8 bits per channel.
std::string to_text(const Session& session, const std::filesystem::path& folder);

}  // namespace shvr
