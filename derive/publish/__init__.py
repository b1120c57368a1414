"""From rendered files to folders on disk, each replaced as a whole or not at all.

A build goes through the modules in this order: `build` (of one robot, or of several one after the other or in
processes); `targets` says what can be written; `render` makes every file in memory, the manifest of `manifest`
included, and compiles libraries; `atomic_folder` writes them into a folder beside the target, has it verified there,
and puts it in the target's place.
"""
