#pragma once
// The dialogs that ask for files and options. Any thread.

#include <cstdint>
#include <span>

#include "engine/base/spelling.h"

namespace shvr::ui {

enum class Dialog : uint8_t {
    none,
    open_with_options,
    load,
    save_as,
    spacing,
    import_scan,
    export_work,
    label,
    compare,
    figure,
    movie,
    keep_look,
    operation  ///< a window: the picture can be turned while it is shown
};
inline constexpr Spelling<Dialog> DIALOGS[] = {
    {Dialog::none, "none"},          {Dialog::open_with_options, "open_with_options"},
    {Dialog::load, "load"},          {Dialog::save_as, "save_as"},
    {Dialog::spacing, "spacing"},    {Dialog::import_scan, "import"},
    {Dialog::export_work, "export"}, {Dialog::label, "label"},
    {Dialog::compare, "compare"},    {Dialog::operation, "operation"},
    {Dialog::figure, "figure"},      {Dialog::movie, "movie"},
    {Dialog::keep_look, "keep_look"}};
constexpr std::span<const Spelling<Dialog>> spellings_of(Dialog)
{
    return DIALOGS;
}

/// Returns whether the dialog is about what is open.
constexpr bool needs_document(Dialog dialog)
{
    return dialog == Dialog::load || dialog == Dialog::save_as || dialog == Dialog::spacing ||
           dialog == Dialog::export_work || dialog == Dialog::label || dialog == Dialog::operation ||
           dialog == Dialog::figure || dialog == Dialog::movie || dialog == Dialog::keep_look;
}

}  // namespace shvr::ui
