# What Debian wants otherwise than an ordinary install: manuals and changelogs compressed (always to the same bits), and
# zsh's completions of packages in a folder of their own. cpack runs this on the files that it is going to pack.
file(GLOB_RECURSE documents "${CPACK_TEMPORARY_DIRECTORY}/*.1" "${CPACK_TEMPORARY_DIRECTORY}/changelog")
foreach(document IN LISTS documents)
  execute_process(COMMAND gzip -9n ${document} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(GLOB_RECURSE completions "${CPACK_TEMPORARY_DIRECTORY}/_polyrecon")
foreach(completion IN LISTS completions)
  cmake_path(GET completion PARENT_PATH folder)
  file(RENAME ${folder} ${folder}/../vendor-completions)
endforeach()
