#include <doctest/doctest.h>

#include "engine/annotation/files/volume_place.h"
#include "engine/formats/open_volume.h"

using namespace shvr;

TEST_CASE("the names of formats are those of one list")
{
    const std::string names = format_names("and");
    CHECK(names == "OME-Zarr, TIFF, NRRD, MetaImage, NIfTI, DICOM, PNG, BMP and JPEG");
    CHECK(format_names("or") == "OME-Zarr, TIFF, NRRD, MetaImage, NIfTI, DICOM, PNG, BMP or JPEG");
    for (const char* name : {"a.tif", "a.TIFF", "a.nrrd", "a.nhdr", "a.mhd", "a.mha", "a.nii", "a.nii.gz", "a.hdr",
                             "a.dcm", "a.ozx", "a.png", "a.BMP", "a.jpg", "a.jpeg"})
        CHECK_MESSAGE(names.find(format_of_name(name)) != std::string::npos, name);
}

TEST_CASE("whether a file states its size is known by its name; raw voxels do not")
{
    for (const char* name : {"a.tif", "a.TIFF", "a.nrrd", "a.nrrd.gz", "a.nhdr", "a.mhd", "a.mha", "a.nii", "a.nii.gz",
                             "a.NII.GZ", "a.hdr", "a.hdr.gz", "a.dcm", "a.ozx", "a.zip", "here/is/a.tif"}) {
        CAPTURE(std::string(name));
        CHECK(name_states_size(name));
        CHECK(states_its_size(name));
    }
    for (const char* name :
         {"a.raw", "a.vol", "a.bin", "a.dat", "a.mask", "a.mask.gz", "a", "a.gz", ".tif", "a.tif.bak"}) {
        CAPTURE(std::string(name));
        CHECK(!name_states_size(name));
        CHECK(!states_its_size(name));
    }
}
