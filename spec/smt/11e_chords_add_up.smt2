; THEOREM    11e: the chord of a whole turn is no longer than the chords of its parts together.
; ASSUMED    From h the robot turns to h1 and on to h2 (any vectors); the two chords are phi1 and
;            phi2 at most.
; CONCLUDED  |h2 - h| <= phi1 + phi2; so too the length of a sum of pieces of way (11a, 11c). As
;            the angle of a turn is what the chords of ever finer parts add up to, a chord is no
;            longer than its angle.
; SOURCE     own; triangle inequality.
; TWIN       the longer of the two chords is taken for both.
; SOLVERS    z3
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const ax Real)       ; from h to h1
(declare-const ay Real)
(declare-const bx Real)       ; from h1 to h2
(declare-const by Real)
(declare-const phi1 Real)     ; first chord, at most
(declare-const phi2 Real)     ; second chord, at most
; Formulas
(define-fun whole () Real (+ phi1 phi2))

; Assumptions
(assert (and (>= phi1 0) (<= (+ (* ax ax) (* ay ay)) (* phi1 phi1))))
(assert (and (>= phi2 0) (<= (+ (* bx bx) (* by by)) (* phi2 phi2))))
(assert (>= (* (- (* ax by) (* ay bx)) (- (* ax by) (* ay bx))) 0))   ; a square: true anyway, a hint for cvc5

; Conclusion, negated
(assert (not (<= (+ (* (+ ax bx) (+ ax bx)) (* (+ ay by) (+ ay by))) (* whole whole))))
(check-sat)
