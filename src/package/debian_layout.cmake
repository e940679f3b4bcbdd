# cpack runs this script on the files before it packs them. Debian wants manuals and changelogs compressed (gzip -n gives
# the same bits in every build), the zsh completions of packages in the folder vendor-completions, and no sections that only
# name the compiler.
file(GLOB_RECURSE documents "${CPACK_TEMPORARY_DIRECTORY}/*.1" "${CPACK_TEMPORARY_DIRECTORY}/changelog")
list(FILTER documents EXCLUDE REGEX "[.]so[.]")  # libpolyrecon.so.1 is no manual
foreach(document IN LISTS documents)
  execute_process(COMMAND gzip -9n ${document} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(GLOB_RECURSE completions "${CPACK_TEMPORARY_DIRECTORY}/_polyrecon")
foreach(completion IN LISTS completions)
  cmake_path(GET completion PARENT_PATH folder)
  file(RENAME ${folder} ${folder}/../vendor-completions)
endforeach()
file(GLOB_RECURSE binaries "${CPACK_TEMPORARY_DIRECTORY}/*")
list(FILTER binaries INCLUDE REGEX "/bin/polyrecon$|[.]so|[.]a$")
foreach(binary IN LISTS binaries)
  if(NOT IS_SYMLINK ${binary})
    execute_process(COMMAND strip --strip-debug --remove-section=.comment --remove-section=.note ${binary}
      COMMAND_ERROR_IS_FATAL ANY)
  endif()
endforeach()
