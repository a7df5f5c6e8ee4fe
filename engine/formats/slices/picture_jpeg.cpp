// Reads JPEG: grey or colour, 8 bits each. Refuses truncated files, whose missing rows libjpeg would fill with grey.

#include <cstdio>

#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>

#include "engine/base/error.h"
#include "engine/formats/slices/picture_file.h"

namespace shvr {
namespace {

/// Maximum samples per byte of a file: every block of 8 x 8 samples takes at least one bit.
constexpr int64_t MAX_EXPANSION = 512;

class JpegPicture final : public PictureFile {
public:
    explicit JpegPicture(const std::filesystem::path& path) : path_(path), file_(open_c_file(path, file_bytes_))
    {
        jpeg_decompress_struct& jpeg = jpeg_.decoder;
        jpeg.err = jpeg_std_error(&errors_);
        jpeg.client_data = this;
        errors_.error_exit = &JpegPicture::leave;
        errors_.emit_message = &JpegPicture::note;
        errors_.output_message = [](j_common_ptr) {};
        read_header();
        layout_.width = jpeg.image_width;
        layout_.height = jpeg.image_height;
        check_picture_size(path_, layout_.width, layout_.height);
        check_expansion(path_, layout_.width * layout_.height, file_bytes_, MAX_EXPANSION);
        if (jpeg.num_components != 1 && jpeg.num_components != 3)
            fail(path.string(), ": has ", jpeg.num_components, " components; expected 1 (grey) or 3 (colours)");
        const int64_t coefficients = layout_.width * layout_.height * jpeg.num_components * int64_t{sizeof(JCOEF)};
        if (jpeg_has_multiple_scans(&jpeg) && coefficients > MAX_WHOLE_PICTURE_BYTES)
            fail(path.string(), ": is progressive and has ", layout_.width, "x", layout_.height,
                 " pixels, which are decoded at once; expected at most ", MAX_WHOLE_PICTURE_BYTES,
                 " bytes of coefficients: save it as a baseline JPEG");
        layout_.samples = jpeg.num_components;
    }

    const PictureLayout& layout() const override { return layout_; }

    void read(int64_t first_row, int64_t end_row, const TakeRow& take) override
    {
        row_.resize(size_t(layout_.width * layout_.samples));
        start();
        for (int64_t y = 0; y < end_row; ++y) {
            read_row();
            if (y >= first_row) take(y, row_);
        }
    }

private:
    static void leave(j_common_ptr jpeg) { std::longjmp(static_cast<JpegPicture*>(jpeg->client_data)->on_error_, 1); }
    /// Turns warnings about damaged pixels into errors; libjpeg by itself would continue.
    static void note(j_common_ptr jpeg, int level)
    {
        if (level < 0 && jpeg->err->msg_code != JWRN_EXTRANEOUS_DATA) leave(jpeg);
    }

    [[noreturn]] void refuse()
    {
        char message[JMSG_LENGTH_MAX] = {};
        errors_.format_message(reinterpret_cast<j_common_ptr>(&jpeg_.decoder), message);
        fail(path_.string(), ": is no sound JPEG (libjpeg: ", message, "); expected one that is complete");
    }

    // On errors, libjpeg uses longjmp to return to the functions below, so these create no objects with destructors.

    void read_header()
    {
        if (setjmp(on_error_) != 0) refuse();
        jpeg_create_decompress(&jpeg_.decoder);
        jpeg_.decoder.mem->max_memory_to_use = long{2} * MAX_WHOLE_PICTURE_BYTES;
        jpeg_stdio_src(&jpeg_.decoder, file_.get());
        static_cast<void>(jpeg_read_header(&jpeg_.decoder, TRUE));
    }

    void start()
    {
        if (setjmp(on_error_) != 0) refuse();
        jpeg_.decoder.out_color_space = layout_.samples == 1 ? JCS_GRAYSCALE : JCS_RGB;
        static_cast<void>(jpeg_start_decompress(&jpeg_.decoder));
    }

    void read_row()
    {
        if (setjmp(on_error_) != 0) refuse();
        JSAMPROW row = reinterpret_cast<JSAMPROW>(row_.data());
        static_cast<void>(jpeg_read_scanlines(&jpeg_.decoder, &row, 1));
    }

    std::filesystem::path path_;
    int64_t file_bytes_ = 0;
    CFile file_;
    jpeg_error_mgr errors_{};
    std::jmp_buf on_error_{};
    struct Decoder {
        jpeg_decompress_struct decoder{};
        Decoder() = default;
        Decoder(const Decoder&) = delete;
        ~Decoder() { jpeg_destroy_decompress(&decoder); }
    };
    Decoder jpeg_;
    PictureLayout layout_;
    std::vector<std::byte> row_;
};

}  // namespace

std::unique_ptr<PictureFile> open_jpeg_picture(const std::filesystem::path& path)
{
    return std::make_unique<JpegPicture>(path);
}

}  // namespace shvr
