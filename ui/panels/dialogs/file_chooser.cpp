#include "ui/panels/dialogs/file_chooser.h"

#include <algorithm>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/error.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace fs = std::filesystem;

namespace {

/// Frames in which one was open, or read a folder, last.
int open_in_frame = -10, reading_in_frame = -10;

bool is_recent(int frame)
{
    return ImGui::GetFrameCount() - frame <= 1;
}

bool is_pressed(ImGuiKey key, bool repeats = true)
{
    return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), repeats);
}

bool enter_is_pressed()
{
    return is_pressed(ImGuiKey_Enter, false) || is_pressed(ImGuiKey_KeyPadEnter, false);
}

std::string with_slash(const fs::path& folder)
{
    std::string text = folder.string();
    return text.ends_with('/') ? text : text + "/";
}

/// Tab completes the path in a field.
int complete(ImGuiInputTextCallbackData* data)
{
    const auto& folder = *static_cast<const fs::path*>(data->UserData);
    const std::string text = completed(std::string(data->Buf, size_t(data->BufTextLen)), folder);
    data->DeleteChars(0, data->BufTextLen);
    data->InsertChars(0, text.c_str());
    return 0;
}

}  // namespace

bool FileChooser::has_keys()
{
    return is_recent(open_in_frame);
}

bool FileChooser::is_busy()
{
    return is_recent(reading_in_frame);
}

void FileChooser::ask(const fs::path& begin, std::vector<Place> places)
{
    places_ = std::move(places);
    is_asked_for_ = true;
    closes_ = false;
    failure_.clear();
    const std::string kept = text_;
    if (begin.empty() && !list_.folder().empty()) {
        enter(list_.folder());  // anew, since it may have changed
        text_ = kept;
    } else {
        std::error_code ignored;
        const fs::path whole = begin.empty() ? home_folder() : fs::absolute(begin).lexically_normal();
        if (fs::is_directory(whole, ignored)) return enter(whole);
        enter(whole.parent_path());
        text_ = whole.string();
    }
    if (const fs::path path = typed_path(text_, list_.folder()); path.parent_path() == list_.folder())
        wanted_name_ = path.filename().string();
}

void FileChooser::ask_again(const fs::path& path, std::vector<Place> places, std::string failure)
{
    ask({}, std::move(places));
    enter(path.parent_path());
    text_ = path.string();
    wanted_name_ = path.filename().string();
    failure_ = std::move(failure);
}

void FileChooser::enter(const fs::path& folder)
{
    list_.enter(folder);
    text_ = with_slash(folder);
    failure_.clear();
    wanted_name_.clear();
    selected_.reset();
    scrolls_ = true;
    ++field_number_;
}

void FileChooser::select(size_t row)
{
    selected_ = row;
    text_ = with_slash(list_.folder()) + list_.at(row).name;
    failure_.clear();
    scrolls_ = true;
    ++field_number_;
}

/// Takes the path, or enters it, or says why not.
void FileChooser::accept(const std::string& typed, bool enters_folders)
{
    const fs::path path = typed_path(typed, list_.folder());
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    const bool is_folder = fs::is_directory(status);
    failure_.clear();
    if (question_.wanted == Wanted::scan) {
        // What lies within an archive is no path of the file system.
        if (!fs::exists(status) && !is_within_archive(path))
            failure_ =
                sentence(path.string(), ": ",
                         error && error != std::errc::no_such_file_or_directory ? error.message()
                                                                                : "there is no such file or folder");
        else if (is_folder && !is_opened_whole(details_of(path).kind))
            return enter(path);
    } else if (is_folder && (enters_folders || question_.wanted == Wanted::new_file)) {
        return enter(path);
    } else if (question_.wanted == Wanted::new_file && fs::exists(status)) {
        failure_ = sentence(path.string(), ": is there already; type another name");
    } else if (!fs::is_directory(path.parent_path(), error)) {
        failure_ = sentence(path.parent_path().string(), ": is no folder; choose one for the file");
    }
    if (!failure_.empty()) {
        field_wants_keys_ = true;
        return;
    }
    // Asked again, it shows the folder that a typed path led to.
    if (path.parent_path() != list_.folder()) {
        enter(path.parent_path());
        wanted_name_ = path.filename().string();
    }
    text_ = path.string();
    accepted_ = path;
}

std::optional<fs::path> FileChooser::draw()
{
    if (is_asked_for_) ImGui::OpenPopup(question_.title);
    if (std::exchange(is_asked_for_, false)) field_wants_keys_ = true;
    const ImGuiViewport& screen = *ImGui::GetMainViewport();
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(screen.GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize(
        {std::min(58.0f * font, 0.94f * screen.WorkSize.x), std::min(36.0f * font, 0.9f * screen.WorkSize.y)},
        ImGuiCond_Appearing);
    accepted_.reset();
    is_open_ = ImGui::BeginPopupModal(question_.title, nullptr, ImGuiWindowFlags_NoSavedSettings);
    if (!is_open_) return std::nullopt;
    open_in_frame = ImGui::GetFrameCount();
    auto result = contents();
    ImGui::EndPopup();
    return result;
}

std::optional<fs::path> FileChooser::contents()
{
    want_glyphs(text_);
    want_glyphs(failure_);
    list_.show(all_files_, hidden_);
    list_.read_on();
    if (list_.is_reading()) reading_in_frame = ImGui::GetFrameCount();
    if (!wanted_name_.empty()) {
        if (const auto row = list_.row_of(wanted_name_)) {
            selected_ = row;
            scrolls_ = true;
            wanted_name_.clear();
        }
    }
    // Rows move while a folder is read.
    if (selected_ && *selected_ >= list_.size()) selected_.reset();

    path_field();
    keys();
    const float below = 3.0f * ImGui::GetFrameHeightWithSpacing() + ImGui::GetStyle().ItemSpacing.y;
    const float height = std::max(ImGui::GetContentRegionAvail().y - below, 4.0f * ImGui::GetFrameHeight());
    place_list();
    ImGui::SameLine();
    file_table(height);

    const std::string& why = failure_.empty() ? list_.failure() : failure_;
    if (why.empty()) {
        ImGui::TextDisabled("%s", question_.note);
    } else {
        ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
        ImGui::TextUnformatted(why.c_str());
        ImGui::PopStyleColor();
    }
    bool changed = false;
    const char* const filters[] = {"What SHVR opens", "All files"};
    int filter = all_files_;
    ImGui::SetNextItemWidth(12.0f * ImGui::GetFontSize());
    if (ImGui::Combo("##filter", &filter, filters, 2)) changed = true, all_files_ = filter == 1;
    ImGui::SameLine();
    changed |= ImGui::Checkbox("Hidden", &hidden_);
    if (changed) {
        wanted_name_ = selected_ ? list_.at(*selected_).name : std::string();
        selected_.reset();
    }
    ImGui::SameLine();
    const std::string count =
        sentence(list_.size(), " shown, ", list_.left_out(), " left out", list_.is_reading() ? ", reading..." : "");
    ImGui::TextDisabled("%s", count.c_str());

    const ImVec2 button{7.0f * ImGui::GetFontSize(), 0.0f};
    if (ImGui::Button(question_.verb, button)) accept(text_, false);
    ImGui::SameLine();
    const bool cancelled = ImGui::Button("Cancel", button) || is_pressed(ImGuiKey_Escape, false) || closes_;
    if (!accepted_ && !cancelled) return std::nullopt;
    closes_ = is_open_ = false;
    ImGui::CloseCurrentPopup();
    return accepted_;
}

void FileChooser::path_field()
{
    if (ImGui::Button("Up")) enter(list_.folder().parent_path());
    hint("to the folder around this one (Backspace in the list)");
    ImGui::SameLine();
    ImGui::PushID(field_number_);
    ImGui::SetNextItemWidth(-1.0f);
    if (std::exchange(field_wants_keys_, false)) ImGui::SetKeyboardFocusHere();
    fs::path folder = list_.folder();
    const bool entered =
        ImGui::InputText("##path", &text_,
                         ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackCompletion |
                             (question_.wanted == Wanted::new_file ? 0 : ImGuiInputTextFlags_AutoSelectAll),
                         complete, &folder);
    field_has_keys_ = ImGui::IsItemActive() || entered;
    if (ImGui::IsItemEdited()) {
        failure_.clear();
        follow_typed();
    }
    ImGui::PopID();
    if (entered) accept(text_, true);
}

/// The list shows the folder of a whole path that is being typed, once its slash is there.
void FileChooser::follow_typed()
{
    if (!text_.ends_with('/') || !(text_.starts_with('/') || text_.starts_with('~'))) return;
    const fs::path folder = typed_path(text_, list_.folder());
    std::error_code ignored;
    if (folder == list_.folder() || !fs::is_directory(folder, ignored)) return;
    list_.enter(folder);
    selected_.reset();
    scrolls_ = true;
}

/// Up and Down go from the field into the list; there letters jump, Backspace goes up, and / or ~ begins a path.
void FileChooser::keys()
{
    const auto step = [&](int64_t rows) {
        if (list_.size() == 0) return;
        const int64_t at = selected_ ? int64_t(*selected_) + rows : rows > 0 ? 0 : int64_t(list_.size()) - 1;
        select(size_t(std::clamp<int64_t>(at, 0, int64_t(list_.size()) - 1)));
    };
    if (is_pressed(ImGuiKey_DownArrow)) return step(1);
    if (is_pressed(ImGuiKey_UpArrow)) return step(-1);
    if (is_pressed(ImGuiKey_PageDown)) return step(12);
    if (is_pressed(ImGuiKey_PageUp)) return step(-12);
    if (field_has_keys_ || ImGui::IsAnyItemActive()) return;
    if (is_pressed(ImGuiKey_Home)) return step(-int64_t(list_.size()));
    if (is_pressed(ImGuiKey_End)) return step(int64_t(list_.size()));
    if (is_pressed(ImGuiKey_Backspace)) return enter(list_.folder().parent_path());
    if (enter_is_pressed()) return accept(text_, true);
    for (const ImWchar typed : ImGui::GetIO().InputQueueCharacters) {
        if (typed == '/' || typed == '~') {
            text_ = typed == '/' ? "/" : "~/";
            field_wants_keys_ = true;
        } else if (typed > ' ' && typed < 127) {
            const char text = char(typed);
            if (const auto row = list_.row_beginning({&text, 1}, selected_ ? *selected_ + 1 : 0)) select(*row);
        }
    }
}

void FileChooser::place_list()
{
    const float below = 3.0f * ImGui::GetFrameHeightWithSpacing() + ImGui::GetStyle().ItemSpacing.y;
    ImGui::BeginChild("places", {11.0f * ImGui::GetFontSize(), -below});
    for (size_t i = 0; i < places_.size(); ++i) {
        ImGui::PushID(int(i));
        want_glyphs(places_[i].folder.native());
        const std::string fitting = shortened(places_[i].name, ImGui::GetContentRegionAvail().x);
        if (ImGui::Selectable(fitting.c_str(), places_[i].folder == list_.folder())) enter(places_[i].folder);
        hint(places_[i].folder.c_str());
        ImGui::PopID();
    }
    ImGui::EndChild();
}

void FileChooser::file_table(float height)
{
    const ImGuiTableFlags flags =
        ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_Resizable | ImGuiTableFlags_BordersInnerV;
    ImGui::PushID(list_.folder().c_str());  // each folder begins at its top
    if (ImGui::BeginTable("files", 4, flags, {0.0f, height})) {
        const float font = ImGui::GetFontSize();
        ImGui::TableSetupScrollFreeze(0, 1);
        ImGui::TableSetupColumn("Name", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("Kind", ImGuiTableColumnFlags_WidthFixed, 9.5f * font);
        ImGui::TableSetupColumn("Size", ImGuiTableColumnFlags_WidthFixed, 4.5f * font);
        ImGui::TableSetupColumn("Changed", ImGuiTableColumnFlags_WidthFixed, 9.5f * font);
        ImGui::TableHeadersRow();
        const float row_height = ImGui::GetTextLineHeight() + 2.0f * ImGui::GetStyle().CellPadding.y;
        if (std::exchange(scrolls_, false) && selected_)
            ImGui::SetScrollY(std::max(0.0f, float(*selected_) * row_height - 0.4f * height));
        std::optional<size_t> clicked, opened;
        ImGuiListClipper clipper;
        clipper.Begin(int(list_.size()), row_height);
        while (clipper.Step()) {
            for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
                const size_t row = size_t(i);
                const FileList::Entry& entry = list_.at(row);
                const FileDetails& details = list_.details(row);
                ImGui::TableNextRow();
                ImGui::TableNextColumn();
                ImGui::PushID(i);
                const std::string name = entry.name + (entry.is_folder ? "/" : "");
                want_glyphs(name);
                if (ImGui::Selectable("##row", selected_ == row,
                                      ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowDoubleClick))
                    (ImGui::IsMouseDoubleClicked(0) ? opened : clicked) = row;
                ImGui::SameLine(0.0f, 0.0f);
                const std::string fitting = shortened(name, ImGui::GetContentRegionAvail().x);
                ImGui::TextUnformatted(fitting.c_str());
                if (fitting != name) hint(name.c_str());
                ImGui::TableNextColumn();
                ImGui::TextDisabled("%s", details.kind_text.c_str());
                ImGui::TableNextColumn();
                ImGui::TextDisabled("%s", details.bytes ? size_text(*details.bytes).c_str() : "");
                ImGui::TableNextColumn();
                ImGui::TextDisabled("%s", details.changed.c_str());
                ImGui::PopID();
            }
        }
        ImGui::EndTable();
        if (clicked || opened) {
            select(clicked ? *clicked : *opened);
            scrolls_ = false;
        }
        if (opened) accept(text_, true);
    }
    ImGui::PopID();
}

}  // namespace shvr::ui
