"""From rendered files to folders on disk, each replaced as a whole or not at all.

A build goes through the modules in this order: `many` (several robots, one after the other or in processes) calls
`build` for each; `targets` says what can be written; `render` makes every file in memory, the manifest of `manifest`
included, and compiles libraries; `publish` writes them into a folder of `staging` beside the target, has it verified
there, and puts it in the target's place.
"""
