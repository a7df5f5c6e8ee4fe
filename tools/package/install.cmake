# Files that `cmake --install` and the packages install, and where. SHVR finds them relative to the program
# (engine/base/assets.h), so that the installed tree can be moved.

set(CMAKE_INSTALL_DOCDIR share/doc/shvr CACHE PATH "Folder of README, changes and copyright")
include(GNUInstallDirs)
set(shared ${CMAKE_INSTALL_DATADIR})

install(TARGETS shvr RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY assets/transfer_functions assets/devices DESTINATION ${shared}/shvr PATTERN README.md EXCLUDE)
install(FILES assets/examples/vessels.session.json DESTINATION ${shared}/shvr/examples)
install(FILES tools/udev/70-shvr-haptics.rules DESTINATION lib/udev/rules.d)
install(FILES tools/package/shvr.desktop DESTINATION ${shared}/applications)
install(FILES tools/package/shvr.metainfo.xml DESTINATION ${shared}/metainfo RENAME io.github.shvr.SHVR.metainfo.xml)
install(FILES tools/package/shvr.mime.xml DESTINATION ${shared}/mime/packages RENAME shvr.xml)
install(FILES tools/package/shvr.svg DESTINATION ${shared}/icons/hicolor/scalable/apps)
install(FILES README.md tools/package/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})

# Manual pages and completions, which the program itself writes, and icons of several sizes. Only for releases.
if(CMAKE_BUILD_TYPE STREQUAL "Release")
    set(made ${CMAKE_BINARY_DIR}/package)
    file(MAKE_DIRECTORY ${made})
    add_custom_command(OUTPUT ${made}/manual.done
        COMMAND ${CMAKE_COMMAND} -E rm -rf ${made}/share
        COMMAND shvr manual ${made}/share
        COMMAND sh -c "gzip -9n share/man/man1/*.1"
        COMMAND ${CMAKE_COMMAND} -E make_directory ${made}/share/doc/shvr
        COMMAND sh -c "gzip -9nc ${CMAKE_SOURCE_DIR}/tools/package/changelog > share/doc/shvr/changelog.Debian.gz"
        COMMAND sh -c "gzip -9nc ${CMAKE_SOURCE_DIR}/tools/package/CHANGELOG.md > share/doc/shvr/changelog.gz"
        COMMAND ${CMAKE_COMMAND} -E touch ${made}/manual.done
        DEPENDS shvr tools/package/changelog tools/package/CHANGELOG.md WORKING_DIRECTORY ${made} VERBATIM
        COMMENT "Writing manual pages and completions")
    set(products ${made}/manual.done)
    find_program(RSVG_CONVERT rsvg-convert)
    if(RSVG_CONVERT)
        foreach(side 16 24 32 48 64 128 256 512)
            set(icon ${made}/share/icons/hicolor/${side}x${side}/apps/shvr.png)
            add_custom_command(OUTPUT ${made}/icon-${side}.done
                COMMAND ${CMAKE_COMMAND} -E make_directory ${made}/share/icons/hicolor/${side}x${side}/apps
                COMMAND ${RSVG_CONVERT} -w ${side} -h ${side} -o ${icon} ${CMAKE_SOURCE_DIR}/tools/package/shvr.svg
                COMMAND ${CMAKE_COMMAND} -E touch ${made}/icon-${side}.done
                DEPENDS ${made}/manual.done tools/package/shvr.svg VERBATIM COMMENT "Icon of ${side} pixels")
            list(APPEND products ${made}/icon-${side}.done)
        endforeach()
    endif()
    add_custom_target(package_files ALL DEPENDS ${products})
    # The user manual. Its pictures are made by carrying out its steps, which needs a Vulkan device and a minute, so it
    # is built on demand:  cmake --build build/release --target manual
    execute_process(COMMAND /usr/bin/python3 -c "import markdown" RESULT_VARIABLE has_no_markdown ERROR_QUIET)
    if(has_no_markdown)
        message(STATUS "No target manual: python3-markdown is missing")
    else()
        file(GLOB manual_pages CONFIGURE_DEPENDS assets/manual/*.md)
        add_custom_command(OUTPUT ${made}/pages.done
            COMMAND ${CMAKE_SOURCE_DIR}/tools/package/make_manual $<TARGET_FILE:shvr> ${made}/share/doc/shvr/manual
            COMMAND ${CMAKE_COMMAND} -E touch ${made}/pages.done
            DEPENDS shvr ${made}/manual.done tools/package/make_manual ${manual_pages} VERBATIM
            COMMENT "Carrying out the steps of the user manual")
        add_custom_target(manual DEPENDS ${made}/pages.done)
    endif()
    install(DIRECTORY ${made}/share/ DESTINATION ${shared})
endif()

# ---- Debian packages: tools/package/build -----------------------------------------------------------------------------

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME shvr)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "see, feel and annotate tubular structures in 3-D scans")
set(CPACK_PACKAGE_DESCRIPTION "SHVR draws micro-CT volumes by ray casting on any Vulkan device, lets a
haptic stylus feel them, and annotates vascular bundles: by painting voxels
and by tracing a network along centre lines. It opens TIFF, DICOM, NRRD,
NIfTI, OME-Zarr and other formats, works on volumes that are larger than
memory, and is scriptable.")
set(CPACK_PACKAGE_VENDOR "The SHVR authors")
set(CPACK_PACKAGE_CONTACT "The SHVR authors <shvr@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_PACKAGE_RELEASE "1${SHVR_PACKAGE_SUFFIX}")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "mesa-vulkan-drivers, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
    "graphviz, ffmpeg, xclip | wl-clipboard, python3-skimage, xdg-utils, fonts-droid-fallback")
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_STRIP_FILES ON)
include(CPack)
