// Entries of the form for opening a file, as settings.

#include <doctest/doctest.h>

#include "engine/workbench/lists/load_form.h"

using namespace shvr;
using namespace shvr::ui;

TEST_CASE("a form states what was filled in, and nothing else")
{
    LoadForm form;
    CHECK(settings_of(form) == "");
    form.channel = "red";
    form.frame = "2";
    CHECK(settings_of(form) == "volume.channel=red\nvolume.frame=2");
    form.level = 2;
    CHECK(settings_of(form) == "volume.channel=red\nvolume.frame=2\nvolume.level=2");
    form.level = 0;
    form.states_spacing = true;
    form.spacing = {0.5, 0.25, 2.0};
    CHECK(settings_of(form) == "volume.channel=red\nvolume.frame=2\nvolume.spacing=[0.5,0.25,2]");
    form.unit = "um";
    form.is_bare = true;  // which has neither channels nor time points
    form.size[0] = 7;
    form.type = VoxelType::int16;
    form.is_big_endian = true;
    form.offset_bytes = 12;
    CHECK(settings_of(form) == "volume.raw=7x512x512:int16:big:12\nvolume.spacing=[0.5,0.25,2]\nvolume.unit=um");
}

TEST_CASE("where a spacing comes from is said")
{
    CHECK(in_words(Provenance::file) == std::string("stated by the file"));
    CHECK(in_words(Provenance::given) == std::string("typed"));
    CHECK(in_words(Provenance::assumed) == std::string("assumed: the file states none"));
    VolumeInfo volume{.size = {3, 4, 5}, .type = VoxelType::uint16, .spacing = {1, 1, 2}, .unit = "um"};
    CHECK(size_in_words(volume) == "3 x 4 x 5 voxels of uint16, each 1 x 1 x 2 \u00b5m");
}
