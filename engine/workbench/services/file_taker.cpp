#include "engine/workbench/services/file_taker.h"

#include <algorithm>
#include <span>

#include "engine/base/assets.h"
#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/session/session_patch.h"
#include "engine/workbench/services/services.h"

namespace shvr::ui {

namespace {

constexpr int64_t MAX_JSON_BYTES = int64_t{16} << 20;

std::vector<std::string> lines_of(const std::string& text)
{
    std::vector<std::string> lines;
    for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.find('\n', begin), text.size());
        if (end > begin) lines.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return lines;
}

/// Otherwise it belongs to what is open.
bool is_opened(FileContent content)
{
    return content == FileContent::volume || content == FileContent::session || content == FileContent::project ||
           content == FileContent::picture;
}

/// Returns whether the points of a transfer function are relative to the tissue of any volume, as in preset files, and
/// not at intensities.
bool is_preset(const std::string& text, const std::filesystem::path& path)
{
    const JsonDocument json(text, path.string());
    const JsonNode points = json.root()["points"];
    return points.is_array() && points.count() > 0 && points.elements()[0]["at"].exists();
}

}  // namespace

FileTaker::FileTaker(Services& all) : Service(all.desk), opener_(all.opener), settings_(all.settings) {}

void FileTaker::act(const Open& action)
{
    candidate_.reset();
    opener_.begin_open(action.path, lines_of(action.settings));
}

/// Opens a copy: the shipped example must stay as it is, since its folder may be read-only and others open it, too.
void FileTaker::act(const OpenExample&)
{
    if (options_.preferences.empty())
        fail("no folder for the example is known; expected HOME or XDG_CONFIG_HOME in the environment");
    const std::filesystem::path own = options_.preferences.parent_path() / "example" / "vessels.json";
    jobs_.start("getting the example", [this, own](ProgressReporter&) {
        const std::filesystem::path shipped = asset_folder("examples") / "vessels.session.json";
        if (!std::filesystem::exists(own)) {
            const std::string text = read_text(shipped, MAX_JSON_BYTES);
            std::filesystem::create_directories(own.parent_path());
            write_file_atomically(own, std::as_bytes(std::span(text)));
        }
        return Jobs::Completion([this, own] { opener_.begin_open(own, {}); });
    });
}

// ---- What a file is, before it is opened ----------------------------------------------------------------------------

void FileTaker::act(const LookAtFile& action)
{
    candidate_.reset();
    if (action.path.empty()) return;
    candidate_ = std::make_unique<Candidate>(Candidate{.path = action.path, .settings = action.settings});
    jobs_.start("looking at " + short_name(action.path), [this, action, &renderer = renderer_](ProgressReporter&) {
        Candidate found{.path = action.path, .settings = action.settings, .is_being_read = false};
        try {
            const UnmeasuredSession opened = open_unmeasured_session(action.path, lines_of(action.settings));
            const Session& session = opened.session;
            found.is_project = !session_file_of(action.path).empty();
            found.kind = !opened.pictured.empty() ? "Picture of a session"
                         : found.is_project       ? "Session or project"
                         : session.raw_layout     ? "Bare voxels"
                                                  : "Volume";
            found.volume = opened.source->info();
            found.levels = opened.source->levels();
            found.warnings = opened.losses;
            for (const std::string& warning : found.volume.warnings) found.warnings.push_back(warning);
            const SceneEstimate estimate =
                renderer.estimate(*opened.source, session.render, shows_occlusion(session.light));
            found.memory = in_words(estimate);
            found.failure = estimate.refusal;
        } catch (const Error& error) {
            found.failure = error.what();
            found.choices = choices_of(error);
        }
        return Jobs::Completion([this, found = std::move(found)] {
            const bool is_wanted =
                candidate_ && candidate_->path == found.path && candidate_->settings == found.settings;
            if (is_wanted) *candidate_ = found;
        });
    });
}

// ---- What is dropped onto the window --------------------------------------------------------------------------------

void FileTaker::act(const TakeFile& action)
{
    std::vector<std::filesystem::path> paths{action.path};
    for (const std::string& line : lines_of(action.beside)) paths.emplace_back(line);
    if (paths.size() > 1) return take_together(std::move(paths));
    std::optional<VolumeInfo> volume;
    if (document_) volume = document_->volume();
    jobs_.start("looking at " + short_name(action.path), [this, path = action.path, volume](ProgressReporter&) {
        const WhatItIs found = what_is(path, volume ? &*volume : nullptr);
        const bool is_function = found.content == FileContent::transfer_function;
        return Jobs::Completion([this, path, found, text = is_function ? read_text(path, MAX_JSON_BYTES) : ""] {
            if (!found.content) fail(found.why_not);
            if (*found.content == FileContent::transfer_function) return take_transfer_function(path, text);
            take(*found.content, path);
        });
    });
}

/// Finds out first what can be opened: annotation dropped with a scan must not go into the document that is still open.
void FileTaker::take_together(std::vector<std::filesystem::path> paths)
{
    jobs_.start(sentence("looking at ", paths.size(), " files"), [this, paths](ProgressReporter&) {
        std::vector<std::filesystem::path> opened, others;
        for (const std::filesystem::path& path : paths) {
            const WhatItIs found = what_is(path, nullptr);
            (found.content && is_opened(*found.content) ? opened : others).push_back(path);
        }
        return Jobs::Completion([this, opened, others] {
            if (opened.size() > 1)
                fail(opened[0].string(), " and ", opened[1].string(),
                     ": each can be opened; expected one scan, session or project at a time, alone or with its mask, "
                     "offsets and trace; slices of one scan are opened as their folder");
            if (opened.size() == 1) return opener_.begin_open(opened[0], {}, others);
            for (const std::filesystem::path& path : others) act(TakeFile{.path = path});
        });
    });
}

void FileTaker::take(FileContent content, const std::filesystem::path& path)
{
    if (is_opened(content)) return opener_.begin_open(path, {});
    if (!document_) fail(path.string(), ": belongs to a volume; expected that to be open, to take it into");
    if (content == FileContent::mask) return take_annotation(Part::mask, path);
    if (content == FileContent::offsets) return take_annotation(Part::offsets, path);
    if (content == FileContent::trace) return take_annotation(Part::trace, path);
}

void FileTaker::take_transfer_function(const std::filesystem::path& path, const std::string& text)
{
    if (!document_) fail(path.string(), ": belongs to a volume; expected that to be open, to take it into");
    if (is_preset(text, path)) {
        Session after = document_->session;
        const TransferPreset preset = parse_transfer_preset(text, path.stem().string(), path.string());
        after.transfer_function = transfer_function_of(preset, document_->statistics);
        settings_.take_session(std::move(after));
    } else {
        settings_.act(Set{patch_of("transfer_function=" + text)});
    }
    settings_.record_settings();
    say("The transfer function of " + path.string() + " is taken; undo takes it back");
}

/// Reads the file on the worker; its content becomes one step of the history.
void FileTaker::take_annotation(Part part, const std::filesystem::path& path)
{
    const VolumeInfo volume = document_->volume();
    WorkFiles files{.volume_hash = document_->session.volume_hash, .volume = volume};
    (part == Part::mask ? files.mask : part == Part::trace ? files.trace : files.density) = path;
    const uint64_t opening = desk_.openings;
    jobs_.start("reading " + short_name(path), [this, part, path, volume, files, opening](ProgressReporter&) {
        const auto found = std::make_shared<shvr::Document>(
            shvr::Document{.mask = Mask(volume.size), .trace = {}, .density = DensityField(volume.size, volume.type)});
        load(part, files, *found);
        return Jobs::Completion([this, part, path, found, opening] {
            if (!document_ || desk_.openings != opening)
                fail(path.string(), ": belongs to a volume that is no longer open");
            Annotator& annotator = document_->annotator;
            if (annotator.stroke_is_running()) fail(path.string(), ": a stroke is being painted; drop it again");
            settings_.record_settings();
            const Command* const command = annotator.perform(sentence(name_of(part), " of ", short_name(path)),
                                                             changes_between(part, annotator.document(), *found));
            if (!command) return say(path.string() + ": its " + name_of(part) + " is already in use");
            settings_.show_changes(*command);
            say(sentence("The ", name_of(part), " of ", path.string(), " is taken; undo takes it back"));
        });
    });
}

}  // namespace shvr::ui
