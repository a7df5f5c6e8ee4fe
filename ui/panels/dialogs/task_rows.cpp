#include "ui/panels/dialogs/task_rows.h"

#include <algorithm>
#include <array>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/workbench/forms/form_names.h"
#include "engine/workbench/forms/voxel_size.h"
#include "engine/workbench/lists/load_form.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/number_field.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Draws the options that the rows leave out, once More is unfolded.
template <class Task>
bool more_rows(Task& task, const Model& model, std::span<const std::string_view> covered)
{
    if (!more_heading()) return false;
    return draw_fields([&](Fields& f) { fields(f, task); }, base_of(model), false, covered);
}

/// Draws a check box, the format and the name of a file.
void export_row(const ExportRow& row)
{
    const float font = ImGui::GetFontSize();
    field_name(row.title);
    ImGui::PushID(row.title);
    ImGui::BeginDisabled(!row.why_not.empty());
    bool is_written = row.part->is_written && row.why_not.empty();
    if (ImGui::Checkbox("##written", &is_written)) row.part->is_written = is_written;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(6.0f * font);
    if (ImGui::BeginCombo("##format", row.part->ending.c_str())) {
        for (const char* ending : row.endings)
            if (ImGui::Selectable(ending, ending == row.part->ending)) row.part->ending = ending;
        ImGui::EndCombo();
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    const std::string size = row.why_not.empty() && !row.size.empty() ? ", " + row.size : "";
    const std::string& words = row.why_not.empty() ? row.file : row.why_not;
    want_glyphs(words);
    const float left = 17.5f * font - ImGui::CalcTextSize(size.c_str()).x;
    ImGui::TextDisabled("%s", (shortened(words, left) + size).c_str());
    hint((words + size).c_str());
    ImGui::PopID();
}

/// Draws the size of a voxel: the file's, until another one is typed.
void spacing_row(ImportForm& form, const KnownScan& known)
{
    field_name("Voxel size");
    const std::string file =
        known ? text_of(VoxelSize{known->scan.spacing, known->scan.unit}) : std::string("as the file states");
    ImGui::InputTextWithHint("##spacing", file.c_str(), &form.voxel_size);
    hint("As in 0.8 x 0.8 x 1.2 um, or 4 um; empty: as the file states.");
}

void reduction_row(ImportTask& task)
{
    constexpr std::array NAMES{"full size", "1/2 along each axis", "1/3 along each axis", "1/4 along each axis"};
    field_name("Size");
    const int at = task.downscale - 1;
    const std::string shown = at < int(NAMES.size()) ? NAMES[size_t(at)] : "1/" + std::to_string(task.downscale);
    if (!ImGui::BeginCombo("##size", shown.c_str())) return;
    for (int each = 0; each < int(NAMES.size()); ++each)
        if (ImGui::Selectable(NAMES[size_t(each)], each == at)) task.downscale = each + 1;
    ImGui::EndCombo();
}

void neighbours_row(LabelTask& task)
{
    constexpr const char* NAMES[] = {"6 (faces)", "26 (faces, edges and corners)"};
    field_name("Neighbours");
    const bool has_corners = task.connectivity == Connectivity::corners;
    if (!ImGui::BeginCombo("##neighbours", NAMES[has_corners])) return;
    if (ImGui::Selectable(NAMES[0], !has_corners)) task.connectivity = Connectivity::faces;
    if (ImGui::Selectable(NAMES[1], has_corners)) task.connectivity = Connectivity::corners;
    ImGui::EndCombo();
}

}  // namespace

bool draw_form(ExportForm& form, const Model& model, const KnownScan&, bool begins)
{
    const bool has_chooser = path_chooser_is_open();
    path_row("Name", form.base, "folder and beginning of the names of all files", base_of(model).parent_path() / "",
             begins);
    for (const ExportRow& row : rows_of(form, model)) export_row(row);
    more_rows(form.more, model, EXPORT_ROWS_COVER);
    return has_chooser;
}

bool draw_form(ImportForm& form, const Model& model, const KnownScan& known, bool begins)
{
    const bool has_chooser = path_chooser_is_open();
    const std::filesystem::path folder = base_of(model).parent_path() / "";
    if (path_row("Scan", form.volume, "a file, a folder of slices, or an address", folder, begins)) follow_volume(form);
    path_row("Project", form.project, "the folder to make", folder);
    spacing_row(form, known);
    reduction_row(form.more);
    more_rows(form.more, model, IMPORT_ROWS_COVER);
    return has_chooser;
}

bool draw_form(LabelForm& form, const Model& model, const KnownScan&, bool begins)
{
    const bool has_chooser = path_chooser_is_open();
    field_name("Threshold");
    if (begins) ImGui::SetKeyboardFocusHere();
    number_field("##threshold", form.more.threshold);
    hint("Voxels at or above it belong to parts.");
    neighbours_row(form.more);
    field_name("Smallest part");
    whole_field("##smallest", form.more.fewest_voxels);
    hint("Voxels; smaller parts are left out.");
    field_name("Write labels");
    ImGui::Checkbox("##writes", &form.writes_labels);
    hint("Otherwise the parts are counted, and nothing is written.");
    if (form.writes_labels)
        path_row("to", form.output, ".zarr, .nrrd, .tif or .mask", base_of(model).parent_path() / "");
    more_rows(form.more, model, LABEL_ROWS_COVER);
    return has_chooser;
}

bool draw_form(CompareForm& form, const Model&, const KnownScan&, bool begins)
{
    return draw_fields([&](Fields& f) { fields(f, form.task); }, {}, begins);
}

std::string about(const ExportForm& form, const Model& model, const KnownScan&)
{
    const ExportTask task = task_of(form, base_of(model).parent_path());
    int64_t files = task.labels ? 1 : 0;
    for (const auto& path : {task.mask, task.offset, task.trace, task.mesh, task.metrics, task.measurements})
        files += !path.empty();
    if (!task.surface.empty()) files += files_of_surfaces(form, model);
    const std::filesystem::path folder = placed_new(form.base, base_of(model).parent_path()).parent_path();
    return sentence("Writes ", files, files == 1 ? " file" : " files", " to ", folder.string(), ".");
}

std::string about(const ImportForm& form, const Model& model, const KnownScan& known)
{
    std::string annotation = words_of_annotation(form, model);
    if (!annotation.empty()) annotation = " " + annotation;
    if (!known)
        return "A project opens at once, however large the scan. The scan's own file stays as it is." + annotation;
    const Size3& size = known->size;
    std::string text = sentence("The scan has ", size_in_words(known->scan), " (", in_words(known->scan.spacing_from),
                                "). The project takes at most ", bytes_in_words(known->most_bytes));
    if (size != known->scan.size) text += sentence(" for ", size.x, " x ", size.y, " x ", size.z, " voxels");
    if (known->free_bytes) text += sentence("; ", bytes_in_words(*known->free_bytes), " are free");
    return text + "." + annotation;
}

std::string about(const LabelForm& form, const Model& model, const KnownScan&)
{
    if (!form.writes_labels) return "Counts the parts; nothing is written.";
    return sentence("The file of labels takes ", size_of_labels(form, model), ".");
}

std::string about(const CompareForm&, const Model&, const KnownScan&)
{
    return {};
}

}  // namespace shvr::ui
