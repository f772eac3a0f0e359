"""The syntax tree: what the text says, token by token, before anything is known about its names.

Guaranteed by the parser: the structure is that of grammar/nid.lark; every node's span lies in the text it
was read from. Equality ignores spans, so that two layouts of one text give equal trees. The nodes stand in
modules by theme, and here all together: this is where they are imported from.
"""
# ruff: noqa: F403

from __future__ import annotations

from cleancli.language.syntax.conditions import *
from cleancli.language.syntax.domain import *
from cleancli.language.syntax.domain import DomainNode
from cleancli.language.syntax.marks import *
from cleancli.language.syntax.node import *
from cleancli.language.syntax.outcomes import *
from cleancli.language.syntax.problem import *
from cleancli.language.syntax.problem import ProblemNode
from cleancli.language.syntax.scene import *
from cleancli.language.syntax.scene import SceneNode, StudyNode
from cleancli.language.syntax.words import *

Root = DomainNode | ProblemNode | SceneNode | StudyNode
