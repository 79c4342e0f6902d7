"""Say the few actions of a robot's plan that tell the listener most.

After Persiani and Hellström, *Informative Communication of Robot Plans*.
"""
